// SPDX-License-Identifier: MIT
#include "local_server.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>
#include <vector>

#include "octavo/core/error.h"

namespace octavo::cli {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::size_t kThreads = 128;
constexpr int kBacklog = 256;
constexpr seconds kKeepAlive{5};
/// For a request to come in whole.
constexpr seconds kRequestTime{10};
/// For a piece of an answer to go out: some kB a second.
constexpr seconds kPieceTime{30};
constexpr std::size_t kPieceBytes = std::size_t{256} << 10;
constexpr std::size_t kMaxBody = std::size_t{64} << 10;
constexpr std::size_t kMaxRequest = std::size_t{96} << 10;
constexpr int kMaxRequests = 100000;
constexpr milliseconds kGlance{200};

/// A connection that gives up on clients which are slow or send too much.
class PatientStream : public httplib::Stream {
public:
    PatientStream(socket_t socket, const std::atomic<bool>& stopping)
        : socket_(socket), stopping_(stopping) {}

    /// Waits for the first byte of a request.
    [[nodiscard]] bool await_request() {
        received_ = 0;
        if (!wait_for(POLLIN, Clock::now() + kKeepAlive)) return false;
        request_ends_ = Clock::now() + kRequestTime;
        return true;
    }

    bool is_readable() const override { return wait_for(POLLIN, request_ends_); }
    bool is_writable() const override { return wait_for(POLLOUT, Clock::now() + kPieceTime); }

    ssize_t read(char* bytes, std::size_t size) override {
        if (begin_ == end_) {
            if (received_ > kMaxRequest || !wait_for(POLLIN, request_ends_)) return -1;
            const ssize_t count = recv(socket_, buffer_.data(), buffer_.size(), 0);
            if (count <= 0) return count;
            begin_ = 0;
            end_ = static_cast<std::size_t>(count);
            received_ += end_;
        }
        const std::size_t count = std::min(size, end_ - begin_);
        std::copy_n(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_), count, bytes);
        begin_ += count;
        return static_cast<ssize_t>(count);
    }

    ssize_t write(const char* bytes, std::size_t size) override {
        const auto end = Clock::now() + kPieceTime;
        for (std::size_t done = 0; done < size;) {
            if (!wait_for(POLLOUT, end)) return -1;
            const ssize_t count =
                send(socket_, bytes + done, size - done, MSG_NOSIGNAL | MSG_DONTWAIT);
            if (count < 0 && errno != EAGAIN && errno != EINTR) return -1;
            if (count > 0) done += static_cast<std::size_t>(count);
        }
        return static_cast<ssize_t>(size);
    }

    void get_remote_ip_and_port(std::string& ip, int& port) const override {
        ip = "127.0.0.1";
        port = 0;
    }
    void get_local_ip_and_port(std::string& ip, int& port) const override {
        ip = "127.0.0.1";
        port = 0;
    }
    socket_t socket() const override { return socket_; }

private:
    bool wait_for(short event, Clock::time_point end) const {
        if (event == POLLIN && begin_ < end_) return true;
        while (!stopping_) {
            const auto left = std::chrono::duration_cast<milliseconds>(end - Clock::now());
            if (left <= milliseconds(0)) return false;
            pollfd one{socket_, event, 0};
            const int found = poll(&one, 1, static_cast<int>(std::min(left, kGlance).count()));
            if (found > 0) return (one.revents & (event | POLLHUP)) != 0;
            if (found < 0 && errno != EINTR) return false;
        }
        return false;
    }

    socket_t socket_;
    const std::atomic<bool>& stopping_;
    Clock::time_point request_ends_;
    std::size_t received_ = 0;  // in this request
    std::array<char, 4096> buffer_;
    std::size_t begin_ = 0;
    std::size_t end_ = 0;
};

/// What a thread knows about the request that it is answering.
struct Current {
    bool range_fails = false;  // no byte of the range exists
    bool close = false;        // its body was not read: nothing more from this connection
};
thread_local Current current;

std::string random_token() {
    std::array<unsigned char, 16> bytes{};
    for (std::size_t done = 0; done < bytes.size();) {
        const ssize_t count = getrandom(bytes.data() + done, bytes.size() - done, 0);
        if (count < 0 && errno != EINTR) throw io_error("random numbers", "read");
        if (count > 0) done += static_cast<std::size_t>(count);
    }
    std::string token;
    for (const unsigned char byte : bytes) {
        token += "0123456789abcdef"[byte >> 4];
        token += "0123456789abcdef"[byte & 15];
    }
    return token;
}

/// Takes as long for a wrong token as for one that is nearly right.
bool same(std::string_view a, std::string_view b) {
    if (a.size() != b.size()) return false;
    unsigned different = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        different |= static_cast<unsigned>(static_cast<unsigned char>(a[i] ^ b[i]));
    return different == 0;
}

}  // namespace

LocalServer::LocalServer(Content content, int port)
    : content_(std::move(content)),
      token_(random_token()),
      file_(content_.file),
      threads_(std::make_unique<ServerThreads>(kThreads)) {
    new_task_queue = [this] { return threads_.release(); };
    set_payload_max_length(kMaxBody);
    set_socket_options([this](socket_t socket) {
        const int yes = 1;
        setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
        fcntl(socket, F_SETFD, FD_CLOEXEC);
        listening_ = socket;
    });
    set_tcp_nodelay(true);
    set_default_headers({{"Cache-Control", "no-store"},
                         {"Content-Security-Policy", "frame-ancestors 'none'"},
                         {"Cross-Origin-Opener-Policy", "same-origin"},
                         {"Cross-Origin-Resource-Policy", "same-origin"},
                         {"Referrer-Policy", "no-referrer"},
                         {"X-Content-Type-Options", "nosniff"},
                         {"X-Frame-Options", "DENY"}});
    set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
        return answer(request, response);
    });
    const auto post = [this](const char* path, const PostHandler& handler) {
        if (!handler) return;
        Post("/" + token_ + path,
             [handler](const httplib::Request& request, httplib::Response& response) {
                 handler(request.body, response);
             });
    };
    post("/render", content_.render);
    post("/pick", content_.pick);

    if (port == 0)
        port_ = bind_to_any_port("127.0.0.1");
    else if (bind_to_port("127.0.0.1", port))
        port_ = port;
    if (port_ <= 0)
        throw Error(Errc::io, "port " + std::to_string(port) +
                                  " of this machine is taken; another "
                                  "--port, or none, may be free");
    ::listen(listening_, kBacklog);
    thread_ = std::thread([this] { listen_after_bind(); });
}

LocalServer::~LocalServer() {
    stopping_ = true;
    // A server that has not begun to listen does not hear stop().
    while (!is_running()) std::this_thread::sleep_for(milliseconds(5));
    stop();
    thread_.join();
}

std::string LocalServer::url() const {
    return "http://127.0.0.1:" + std::to_string(port_) + "/" + token_ + "/";
}

bool LocalServer::process_and_close_socket(socket_t socket) {
    PatientStream stream(socket, stopping_);
    bool good = true;
    try {
        for (int i = 0; good && i < kMaxRequests && stream.await_request(); ++i) {
            current = {};
            bool closed = false;
            good = process_request(stream, false, closed,
                                   [this](httplib::Request& request) { clip_ranges(request); });
            good = good && !closed && !current.close;
        }
    } catch (const std::exception&) {
        // Whatever goes wrong, out of memory as a rule, ends this connection and no other.
        good = false;
    }
    shutdown(socket, SHUT_RDWR);
    close(socket);
    return good;
}

/// Leaves at most one range, of bytes that exist.
void LocalServer::clip_ranges(httplib::Request& request) const {
    if (request.ranges.empty()) return;
    auto [first, last] = request.ranges.front();
    const auto size = static_cast<ssize_t>(file_.size());
    const bool one = request.ranges.size() == 1;
    request.ranges.clear();
    if (request.path != "/" + token_ + "/scene.octv") return;
    if (first == -1) {  // the last so many bytes
        first = std::max<ssize_t>(0, size - last);
        last = size - 1;
    }
    if (last == -1 || last >= size) last = size - 1;
    current.range_fails = !one || first > last;
    if (!current.range_fails) request.ranges = {{first, last}};
}

bool LocalServer::is_own_host(const httplib::Request& request) const {
    if (request.get_header_value_count("Host") != 1) return false;
    const std::string host = request.get_header_value("Host");
    const std::string port = std::to_string(port_);
    const std::size_t colon = host.find(':');
    if (colon == std::string::npos || host.substr(colon + 1) != port) return false;
    const std::string name = host.substr(0, colon);
    return name == "127.0.0.1" || name == "localhost";
}

LocalServer::HandlerResponse LocalServer::refuse(httplib::Response& response, int status) const {
    response.status = status;
    response.set_content("refused\n", "text/plain");
    current.close = true;
    return HandlerResponse::Handled;
}

LocalServer::HandlerResponse LocalServer::answer(const httplib::Request& request,
                                                 httplib::Response& response) {
    if (!is_own_host(request)) return refuse(response, 403);
    const std::size_t end = std::min(request.path.find('/', 1), request.path.size());
    if (!same(request.path.substr(0, end), "/" + token_)) return refuse(response, 404);
    const std::string path = request.path.substr(end);
    if (request.method == "POST" &&
        ((path == "/render" && content_.render) || (path == "/pick" && content_.pick)))
        return HandlerResponse::Unhandled;  // the body is read first
    if (path != "/" && path != "/scene.octv") return refuse(response, 404);
    if (request.method != "GET" && request.method != "HEAD") {
        response.set_header("Allow", "GET, HEAD");
        return refuse(response, 405);
    }
    if (current.range_fails) {
        response.set_header("Content-Range", "bytes */" + std::to_string(file_.size()));
        return refuse(response, 416);
    }
    if (path == "/")
        response.set_content(content_.page, "text/html; charset=utf-8");
    else
        serve_file(response);
    return HandlerResponse::Handled;
}

void LocalServer::serve_file(httplib::Response& response) const {
    response.set_header("Accept-Ranges", "bytes");
    if (file_.size() == 0) return response.set_content("", "application/octet-stream");
    response.set_content_provider(
        file_.size(), "application/octet-stream",
        [this](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
            std::vector<char> bytes(std::min(length, kPieceBytes));
            const ssize_t count =
                pread(file_.descriptor(), bytes.data(), bytes.size(), static_cast<off_t>(offset));
            return count > 0 && sink.write(bytes.data(), static_cast<std::size_t>(count));
        });
}

}  // namespace octavo::cli
