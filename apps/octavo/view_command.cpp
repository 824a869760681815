// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "arguments.h"
#include "commands.h"
#include "help.h"
#include "interrupt.h"
#include "octavo/io/octv.h"
#include "output.h"
#include "viewer_page.h"
#if OCTAVO_HAS_SERVER
#include "local_server.h"
#include "remote_picture.h"
#endif

namespace octavo::cli {
namespace {

constexpr const char* kExamples =
    "  octavo view scene.octv\n"
    "  octavo view scene.octv --port 8080 --no-open     # behind an SSH tunnel, say\n"
    "  octavo view scene.octv --render-here             # this machine draws, the browser shows\n";

struct ViewArguments {
    std::filesystem::path file;
    int port = 0;
    bool no_open = false;
    bool render_here = false;
};

#if OCTAVO_HAS_SERVER
/// Opens the user's browser, without a shell in between. What it says goes nowhere.
bool open_browser(const std::string& url) {
    posix_spawn_file_actions_t streams;
    posix_spawn_file_actions_init(&streams);
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        posix_spawn_file_actions_addopen(&streams, stream, "/dev/null", O_RDWR, 0);
    std::string program = "xdg-open";
    std::string argument = url;
    char* arguments[] = {program.data(), argument.data(), nullptr};
    pid_t child = 0;
    const int failed = posix_spawnp(&child, program.c_str(), &streams, nullptr, arguments, environ);
    posix_spawn_file_actions_destroy(&streams);
    if (failed != 0) return false;
    std::thread([child] { waitpid(child, nullptr, 0); }).detach();
    return true;
}

void run_view(const ViewArguments& arguments) {
    const std::string name = arguments.file.filename().string();
    nlohmann::json config = {{"name", name}, {"url", "scene.octv"}};
    LocalServer::Content content;
    content.file = arguments.file;
    (void)viewer_page();  // before anything takes time
    std::unique_ptr<RemotePicture> painter;
    if (arguments.render_here) {
        painter = std::make_unique<RemotePicture>(arguments.file);
        config["render"] = painter->config();
        content.render = [&painter](const std::string& body, httplib::Response& response) {
            painter->render(body, response);
        };
        content.pick = [&painter](const std::string& body, httplib::Response& response) {
            painter->pick(body, response);
        };
    } else {
        (void)read_octv_summary(arguments.file);  // the page checks the rest
    }
    content.page = configured_page(config);

    catch_interrupts();
    const LocalServer server(std::move(content), arguments.port);
    print(server.url() + "\n");
    if (!arguments.no_open && !open_browser(server.url()))
        fmt::print(stderr, "octavo: no browser could be opened; open the address yourself\n");
    while (!interrupted()) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    if (painter) painter->stop();
}
#else
void run_view(const ViewArguments&) {
    throw Error(Errc::unsupported,
                "this build has no viewer: it was made without cpp-httplib and libturbojpeg "
                "(libcpp-httplib-dev, libturbojpeg0-dev)");
}
#endif

}  // namespace

void add_view_command(CLI::App& program) {
    CLI::App& command =
        *program.add_subcommand("view", "Look at an .octv file in the browser, until Ctrl-C");
    const auto arguments = std::make_shared<ViewArguments>();
    set_help(command, kExamples);
    command.add_option("FILE", arguments->file, "An .octv file")->required()->type_name("");
    command
        .add_option("--port", arguments->port,
                    "The port on 127.0.0.1 to serve at; otherwise any that is free")
        ->type_name("N")
        ->check(within(0, 65535));
    command.add_flag("--no-open", arguments->no_open, "Print the address, and open no browser");
    command.add_flag("--render-here", arguments->render_here,
                     "Draw on this machine and send pictures: for scenes larger than the browser's "
                     "GPU can hold");
    command.callback([arguments] { run_view(*arguments); });
}

}  // namespace octavo::cli
