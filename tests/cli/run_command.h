// SPDX-License-Identifier: MIT
#pragma once

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "support/temporary_folder.h"

namespace octavo::test {

struct Outcome {
    int code = 0;  // exit code, or 128 + the signal that ended it
    std::string out;
    std::string err;
    std::uint64_t peak_bytes = 0;  // resident memory, the most of any one of its processes
};

inline int exit_code_of(int status) {
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Runs a line of shell in a folder, with the freshly built octavo first in the PATH.
inline Outcome run_shell(const std::filesystem::path& folder, const std::string& line) {
    const TemporaryFolder streams;
    const pid_t child = fork();
    if (child == 0) {
        const std::string path = std::filesystem::path(OCTAVO_COMMAND).parent_path().string() +
                                 ":" + std::getenv("PATH");
        setenv("PATH", path.c_str(), 1);
        const int out = open((streams / "out").c_str(), O_WRONLY | O_CREAT, 0600);
        const int err = open((streams / "err").c_str(), O_WRONLY | O_CREAT, 0600);
        if (chdir(folder.c_str()) != 0 || dup2(out, 1) < 0 || dup2(err, 2) < 0) _exit(126);
        execl("/bin/bash", "bash", "-c", line.c_str(), nullptr);
        _exit(127);
    }
    int status = 0;
    rusage usage{};
    wait4(child, &status, 0, &usage);
    return {exit_code_of(status), file_content(streams / "out"), file_content(streams / "err"),
            static_cast<std::uint64_t>(usage.ru_maxrss) * 1024};
}

/// Runs a line that serves the viewer until it says its address, and interrupts it once. Its words
/// to both streams are in .out.
inline Outcome serve_and_interrupt(const std::filesystem::path& folder, const std::string& line) {
    // In the foreground timeout passes a signal on once; else twice, and the second ends a program.
    return run_shell(folder, "timeout --foreground 60 " + line +
                                 " --no-open --port 0 >served.log 2>&1 & pid=$!\n"
                                 "until grep -q http served.log || ! kill -0 $pid; do sleep 0.1; "
                                 "done\n"
                                 "kill -INT $pid; wait $pid; code=$?; cat served.log; exit $code");
}

/// The sample's DAG at 64^3, made once for each test program.
inline std::filesystem::path small_octv() {
    static const TemporaryFolder folder;
    std::filesystem::path file = folder / "small.octv";
    if (!std::filesystem::exists(file))
        run_shell(folder.path(), "octavo build sample:courtyard -o small.octv -r 64 --quiet");
    return file;
}

inline int lines_in(const std::string& text) {
    return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace octavo::test
