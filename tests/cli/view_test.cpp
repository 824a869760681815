// SPDX-License-Identifier: MIT
//
// `octavo view` as a client sees it, friendly or not, and what `octavo export` writes.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "cli/run_command.h"
#include "support/sanitized.h"

namespace octavo::test {
namespace {

/// Why this build cannot show anything; empty where it can.
std::string missing_viewer() {
    static const std::string missing = [] {
        const TemporaryFolder folder;
        const Outcome outcome = run_shell(
            folder.path(), "octavo export '" + small_octv().string() + "' --html page.html");
        return outcome.err.find("no viewer") != std::string::npos ? outcome.err : std::string();
    }();
    return missing;
}

/// A server that lives as long as this.
class Viewing {
public:
    explicit Viewing(std::vector<std::string> more = {}) {
        int ends[2];
        if (pipe(ends) != 0) return;
        const std::string file = small_octv().string();
        child_ = fork();
        if (child_ == 0) {
            dup2(ends[1], 1);
            close(ends[0]);
            close(ends[1]);
            std::vector<std::string> words = {OCTAVO_COMMAND, "view", file, "--no-open"};
            words.insert(words.end(), more.begin(), more.end());
            std::vector<char*> arguments;
            for (std::string& word : words) arguments.push_back(word.data());
            arguments.push_back(nullptr);
            execv(OCTAVO_COMMAND, arguments.data());
            _exit(127);
        }
        close(ends[1]);
        char letter = 0;
        while (read(ends[0], &letter, 1) == 1 && letter != '\n') url_ += letter;
        close(ends[0]);
        const std::size_t colon = url_.rfind(':');
        if (colon == std::string::npos) return;
        port_ = std::stoi(url_.substr(colon + 1));
        path_ = url_.substr(url_.find('/', colon));
    }
    ~Viewing() { end(); }

    /// Interrupts it. @return its exit code
    int end() {
        if (child_ <= 0) return code_;
        kill(child_, SIGINT);
        int status = 0;
        waitpid(child_, &status, 0);
        child_ = 0;
        return code_ = exit_code_of(status);
    }

    /// From now on it can take so much more address space and no more.
    void leave_memory_for(std::uint64_t bytes) const {
        std::ifstream statm("/proc/" + std::to_string(child_) + "/statm");
        std::uint64_t pages = 0;
        statm >> pages;
        const rlim_t most = pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) + bytes;
        const rlimit limit{most, most};
        EXPECT_EQ(prlimit(child_, RLIMIT_AS, &limit, nullptr), 0);
    }

    [[nodiscard]] int port() const { return port_; }
    [[nodiscard]] std::string host() const { return "127.0.0.1:" + std::to_string(port_); }
    /// "/TOKEN/"
    [[nodiscard]] const std::string& path() const { return path_; }

private:
    pid_t child_ = 0;
    int code_ = -1;
    std::string url_;
    int port_ = 0;
    std::string path_;
};

class Connection {
public:
    explicit Connection(int port) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(static_cast<std::uint16_t>(port));
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        const timeval patience{40, 0};
        setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
        good_ = connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
    }
    ~Connection() { close(socket_); }
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    bool say(const std::string& text) const {
        return good_ && send(socket_, text.data(), text.size(), MSG_NOSIGNAL) ==
                            static_cast<ssize_t>(text.size());
    }
    /// All that comes until the other side closes.
    [[nodiscard]] std::string listen() const {
        std::string answer;
        std::array<char, 65536> bytes{};
        for (ssize_t n; (n = recv(socket_, bytes.data(), bytes.size(), 0)) > 0;)
            answer.append(bytes.data(), static_cast<std::size_t>(n));
        return answer;
    }

private:
    int socket_;
    bool good_ = false;
};

std::string request(int port, const std::string& head, const std::string& body = "") {
    const Connection connection(port);
    connection.say(head + "\r\n\r\n" + body);
    return connection.listen();
}

std::string get(const Viewing& view, const std::string& path, const std::string& more = "") {
    return request(view.port(), "GET " + path + " HTTP/1.1\r\nHost: " + view.host() +
                                    "\r\nConnection: close" + more);
}

std::string post(const Viewing& view, const std::string& path, const std::string& body) {
    return request(view.port(),
                   "POST " + path + " HTTP/1.1\r\nHost: " + view.host() +
                       "\r\nConnection: close\r\nContent-Type: application/json"
                       "\r\nContent-Length: " +
                       std::to_string(body.size()),
                   body);
}

int status_of(const std::string& answer) {
    return answer.starts_with("HTTP/1.1 ") ? std::stoi(answer.substr(9)) : 0;
}
std::string body_of(const std::string& answer) {
    const std::size_t at = answer.find("\r\n\r\n");
    return at == std::string::npos ? "" : answer.substr(at + 4);
}

class View : public testing::Test {
protected:
    void SetUp() override {
        if (!missing_viewer().empty()) GTEST_SKIP() << missing_viewer();
    }
};
using ViewSlow = View;
using Export = View;

TEST_F(View, ServesThePageAndTheFileBelowItsToken) {
    const Viewing view;
    ASSERT_GE(view.path().size(), 34u);
    EXPECT_EQ(status_of(get(view, view.path())), 200);
    EXPECT_NE(get(view, view.path()).find("<canvas"), std::string::npos);
    EXPECT_EQ(body_of(get(view, view.path() + "scene.octv")), file_content(small_octv()));
}

TEST_F(View, ListensOnTheLoopbackAddressOnly) {
    const Viewing view;
    // "sl local_address ...": address and port in hexadecimal, the address lowest byte first.
    std::ifstream sockets("/proc/net/tcp");
    if (!sockets) GTEST_SKIP() << "no /proc/net/tcp here";
    char port[8];
    std::snprintf(port, sizeof port, ":%04X", static_cast<unsigned>(view.port()));
    int listening = 0;
    for (std::string line; std::getline(sockets, line);) {
        std::istringstream words(line);
        std::string number, local, remote, state;
        words >> number >> local >> remote >> state;
        if (!local.ends_with(port) || state != "0A") continue;
        EXPECT_EQ(local.substr(0, 8), "0100007F");
        ++listening;
    }
    EXPECT_EQ(listening, 1);
    std::ifstream sockets6("/proc/net/tcp6");
    for (std::string line; std::getline(sockets6, line);)
        EXPECT_EQ(line.find(std::string(port) + " 00000000000000000000000000000000:0000 0A"),
                  std::string::npos);
}

TEST_F(View, HasAnotherTokenEachTime) {
    const Viewing first;
    const Viewing second;
    EXPECT_NE(first.path(), second.path());
}

TEST_F(View, TellsNothingWithoutTheToken) {
    const Viewing view;
    std::string near = view.path();
    near[near.size() - 2] = near[near.size() - 2] == 'a' ? 'b' : 'a';
    for (const std::string& path :
         {std::string("/"), std::string("/scene.octv"), std::string("/index.html"), near,
          near + "scene.octv", view.path().substr(0, 20) + "/", "//" + view.path()}) {
        const std::string answer = get(view, path);
        EXPECT_EQ(status_of(answer), 404) << path;
        EXPECT_LT(body_of(answer).size(), 32u) << path;
    }
}

TEST_F(View, GivesNoOtherFile) {
    const Viewing view;
    for (const char* path : {"../../../../etc/passwd", "..%2f..%2f..%2fetc/passwd", "etc/passwd",
                             "scene.octv/../../etc/passwd", "%2e%2e/%2e%2e/etc/passwd",
                             "small.octv", "scene.octv%00.html", "render", "pick"})
        EXPECT_EQ(status_of(get(view, view.path() + path)), 404) << path;
}

TEST_F(View, RefusesOtherHostNames) {
    const Viewing view;
    const std::string head = "GET " + view.path() + " HTTP/1.1\r\nConnection: close";
    const std::string port = ":" + std::to_string(view.port());
    for (const std::string& host :
         {"\r\nHost: evil.example" + port, std::string("\r\nHost: 127.0.0.1"), std::string(),
          "\r\nHost: 127.0.0.1.evil.example" + port, "\r\nHost: 127.0.0.1" + port + port,
          "\r\nHost: 127.0.0.1" + port + "\r\nHost: evil.example"})
        EXPECT_EQ(status_of(request(view.port(), head + host)), 403) << host;
    EXPECT_EQ(status_of(request(view.port(), head + "\r\nHost: localhost" + port)), 200);
}

TEST_F(View, AnswersRanges) {
    const Viewing view;
    const std::string file = file_content(small_octv());
    const auto range = [&](const std::string& bytes) {
        return get(view, view.path() + "scene.octv", "\r\nRange: bytes=" + bytes);
    };
    const std::string first = range("0-7");
    EXPECT_EQ(status_of(first), 206);
    EXPECT_EQ(body_of(first), file.substr(0, 8));
    EXPECT_NE(first.find("Content-Range: bytes 0-7/" + std::to_string(file.size())),
              std::string::npos);
    EXPECT_EQ(body_of(range("100-")), file.substr(100));
    EXPECT_EQ(body_of(range("-5")), file.substr(file.size() - 5));
    EXPECT_EQ(body_of(range("4096-99999999")), file.substr(4096)) << "cut at the end";
    EXPECT_EQ(status_of(range("99999999-")), 416);
    EXPECT_EQ(status_of(range("9-3")), 416);
    EXPECT_EQ(status_of(range("0-1,3-4")), 416) << "one range at a time";
    EXPECT_EQ(status_of(range(std::string(7000, '0') + "-")), 206) << "a long zero";
}

TEST_F(View, RefusesOtherMethods) {
    const Viewing view;
    for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "PATCH"})
        EXPECT_EQ(status_of(request(view.port(), std::string(method) + " " + view.path() +
                                                     " HTTP/1.1\r\nHost: " + view.host() +
                                                     "\r\nContent-Length: 0\r\nConnection: close")),
                  405)
            << method;
    const std::string head =
        request(view.port(), "HEAD " + view.path() + "scene.octv HTTP/1.1" +
                                 "\r\nHost: " + view.host() + "\r\nConnection: close");
    EXPECT_EQ(status_of(head), 200);
    EXPECT_TRUE(body_of(head).empty());
}

TEST_F(View, CutsOffRequestsThatAreTooLarge) {
    const Viewing view;
    const std::string begin = "GET " + view.path() + " HTTP/1.1\r\nHost: " + view.host();
    for (const std::string& much : {begin + "\r\nX: " + std::string(1 << 20, 'x'),
                                    "GET /" + std::string(1 << 20, 'x') + " HTTP/1.1", [&] {
                                        std::string many = begin;
                                        for (int i = 0; i < 50000; ++i) many += "\r\nA: b";
                                        return many;
                                    }()}) {
        const Connection connection(view.port());
        connection.say(much + "\r\n\r\n");
        EXPECT_NE(status_of(connection.listen()), 200);
    }
    EXPECT_EQ(status_of(get(view, view.path())), 200) << "it still serves";
}

TEST_F(View, ServesAHundredClientsAtOnce) {
    const Viewing view;
    const std::string file = file_content(small_octv());
    std::atomic<int> right = 0;
    std::vector<std::thread> clients;
    for (int i = 0; i < 100; ++i)
        clients.emplace_back([&] {
            for (int k = 0; k < 3; ++k)
                right += body_of(get(view, view.path() + "scene.octv")) == file ? 1 : 0;
        });
    for (std::thread& client : clients) client.join();
    EXPECT_EQ(right, 300);
}

TEST_F(ViewSlow, CutsOffThoseWhoDawdleAndServesOthersMeanwhile) {
    const Viewing view;
    std::vector<std::unique_ptr<Connection>> dawdlers;
    for (int i = 0; i < 100; ++i) {
        dawdlers.push_back(std::make_unique<Connection>(view.port()));
        dawdlers.back()->say("GET " + view.path() + " HTTP/1.1\r\nX: ");
    }
    const auto began = std::chrono::steady_clock::now();
    EXPECT_EQ(status_of(get(view, view.path())), 200);
    bool cut = false;
    while (!cut && std::chrono::steady_clock::now() - began < std::chrono::seconds(25)) {
        std::this_thread::sleep_for(std::chrono::milliseconds(500));
        cut = !dawdlers.front()->say("x");
    }
    EXPECT_TRUE(cut) << "a byte every half second holds a connection for good";
}

TEST_F(View, EndsWellWhenInterrupted) {
    Viewing view;
    const Connection open(view.port());
    EXPECT_EQ(view.end(), 0);
}

TEST_F(View, SaysWhyItDoesNotStart) {
    const Viewing view;
    const TemporaryFolder folder;
    const std::string file = "'" + small_octv().string() + "'";
    const Outcome taken = run_shell(
        folder.path(), "octavo view " + file + " --no-open --port " + std::to_string(view.port()));
    EXPECT_EQ(taken.code, 1);
    EXPECT_NE(taken.err.find("taken"), std::string::npos) << taken.err;
    EXPECT_EQ(run_shell(folder.path(), "octavo view none.octv --no-open").code, 1);
    EXPECT_EQ(run_shell(folder.path(), "echo x > bad.octv; octavo view bad.octv --no-open").code,
              3);
}

const std::string kWish =
    R"({"page":"p","number":1,"mode":"shaded","level":17,"detail":1,)"
    R"("width":64,"height":40,"eye":[0,10,15],"forward":[0,-0.3,-1],)"
    R"("up":[0,1,0],"fov":0.8,"shadows":"soft","ambient":true,"reach":2,"smooth":true,)"
    R"("stored":false,)"
    R"("light":-1,"azimuth":0.5,"elevation":0.7,"size":0.02,"exposure":0})";

TEST_F(View, RenderHereSendsPicturesThatGrowSharper) {
    const Viewing view({"--render-here"});
    const std::string answer = post(view, view.path() + "render", kWish);
    EXPECT_EQ(status_of(answer), 200);
    EXPECT_NE(answer.find("\xff\xd8\xff"), std::string::npos) << "JPEG first";
    EXPECT_NE(answer.find("\x89PNG\r\n"), std::string::npos) << "PNG at last";
    EXPECT_LT(answer.find("\xff\xd8\xff"), answer.find("\x89PNG\r\n"));
}

TEST_F(View, RenderHereRefusesWishesThatMakeNoSense) {
    const Viewing view({"--render-here"});
    const auto with = [](const std::string& old_text, const std::string& text) {
        std::string wish = kWish;
        return wish.replace(wish.find(old_text), old_text.size(), text);
    };
    for (const std::string& body :
         {std::string(), std::string("{}"), std::string("[1"), with("64", "100000"),
          with("64", "-1"), with("\"fov\":0.8", "\"fov\":0"), with("[0,-0.3,-1]", "[0,0,0]"),
          with("[0,10,15]", "[0,1e999,0]"), with("[0,10,15]", "\"x\""),
          with("\"reach\":2", "\"reach\":\"far\""), with("shaded", "blurred"),
          with("\"detail\":1", "\"detail\":-1"), with("\"level\":17", "\"level\":[]")})
        EXPECT_EQ(status_of(post(view, view.path() + "render", body)), 400) << body;
    EXPECT_EQ(status_of(post(view, view.path() + "render", std::string(70000, ' '))), 413);
    EXPECT_EQ(status_of(post(view, "/render", kWish)), 404);
}

TEST_F(View, RenderHereOutlivesRequestsThatNoMemoryHolds) {
    if (kSanitized) GTEST_SKIP() << "their shadow needs more address space than there is";
    Viewing view({"--render-here"});
    ASSERT_EQ(status_of(post(view, view.path() + "render", kWish)), 200);
    view.leave_memory_for(std::uint64_t{96} << 20);
    std::string large = kWish;
    for (const char* side : {":64", ":40"}) large.replace(large.find(side), 3, ":4096");
    for (int i = 0; i < 3; ++i) {
        const std::string answer = post(view, view.path() + "render", large);
        EXPECT_EQ(answer.find("\x89PNG\r\n"), std::string::npos) << "it had room enough";
    }
    const std::string small = post(view, view.path() + "render", kWish);
    EXPECT_NE(small.find("\x89PNG\r\n"), std::string::npos);
    EXPECT_EQ(body_of(get(view, view.path() + "scene.octv")), file_content(small_octv()));
    EXPECT_LT(view.end(), 128 + 3);  // as any other interrupted program, not aborted
}

TEST_F(View, RenderHereFindsVoxels) {
    const Viewing view({"--render-here"});
    const std::string hit =
        post(view, view.path() + "pick", R"({"eye":[0,50,0],"direction":[0,-1,0]})");
    EXPECT_NE(body_of(hit).find("\"path\""), std::string::npos) << hit;
    EXPECT_EQ(body_of(post(view, view.path() + "pick", R"({"eye":[0,50,0],"direction":[0,1,0]})")),
              "null");
}

TEST_F(Export, WritesAFolderForAnyServer) {
    const TemporaryFolder folder;
    const std::string line = "octavo export '" + small_octv().string() + "' --html site";
    ASSERT_EQ(run_shell(folder.path(), line).code, 0);
    EXPECT_EQ(file_content(folder / "site/scene.octv"), file_content(small_octv()));
    EXPECT_NE(file_content(folder / "site/index.html").find("\"scene.octv\""), std::string::npos);
    EXPECT_EQ(run_shell(folder.path(), line).code, 1) << "it is there already";
    EXPECT_EQ(run_shell(folder.path(), line + " --force").code, 0);
}

TEST_F(Export, WritesOneFileThatHoldsTheScene) {
    const TemporaryFolder folder;
    ASSERT_EQ(run_shell(folder.path(), "octavo export '" + small_octv().string() +
                                           "' --html page.html; sed -n 's/.*id=\"octavo-scene\">"
                                           "\\([^<]*\\).*/\\1/p' page.html | base64 -d > out.octv")
                  .code,
              0);
    EXPECT_EQ(file_content(folder / "out.octv"), file_content(small_octv()));
}

TEST_F(Export, RefusesDamagedFiles) {
    const TemporaryFolder folder;
    EXPECT_EQ(run_shell(folder.path(), "head -c 9000 '" + small_octv().string() +
                                           "' > cut.octv; octavo export cut.octv --html site")
                  .code,
              3);
}

}  // namespace
}  // namespace octavo::test
