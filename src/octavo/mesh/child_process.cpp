// SPDX-License-Identifier: MIT
#include "octavo/mesh/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <fstream>
#include <new>
#include <string>

#include "octavo/core/error.h"
#include "octavo/mesh/scene_archive.h"

namespace octavo {
namespace {

class Descriptor {
public:
    explicit Descriptor(int value) : value_(value) {}
    ~Descriptor() {
        if (value_ >= 0) close(value_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    [[nodiscard]] int get() const { return value_; }

private:
    int value_;
};

// How the child ends; an Error's code follows kFailed as a number.
constexpr int kDone = 0;
constexpr int kOutOfMemory = 1;
constexpr int kFailed = 2;

std::uint64_t address_space_bytes() {
    std::ifstream statm("/proc/self/statm");
    std::uint64_t pages = 0;
    statm >> pages;
    return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

void write_all(int descriptor, const std::string& text) {
    std::size_t done = 0;
    while (done < text.size()) {
        const ssize_t count = write(descriptor, text.data() + done, text.size() - done);
        if (count < 0 && errno != EINTR) return;
        if (count > 0) done += static_cast<std::size_t>(count);
    }
}

/// What the library prints is neither the program's answer nor its one line of an error.
void silence_standard_streams() {
    const Descriptor nowhere(open("/dev/null", O_WRONLY | O_CLOEXEC));
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO})
        if (nowhere.get() < 0 || dup2(nowhere.get(), stream) < 0) close(stream);
}

[[noreturn]] void run_child(int result, const std::function<Scene()>& read,
                            std::uint64_t max_address_space) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // nobody waits for it any more
    silence_standard_streams();
    const rlimit no_core{0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    const rlimit memory{max_address_space, max_address_space};
    setrlimit(RLIMIT_AS, &memory);
    // The library turns a bad_alloc into a text like any other failure.
    std::set_new_handler([] { _exit(kOutOfMemory); });
    for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL})
        std::signal(signal, SIG_DFL);
    try {
        Scene scene = read();
        write_scene(result, scene);
        _exit(kDone);
    } catch (const Error& error) {
        write_all(result, error.what());
        _exit(kFailed + static_cast<int>(error.code()));
    } catch (const std::bad_alloc&) {
        _exit(kOutOfMemory);
    } catch (const std::exception& error) {
        write_all(result, error.what());
        _exit(kFailed + static_cast<int>(Errc::bad_input));
    }
}

/// Waits for the child, and kills it when its time is over. @return its status; none: killed
std::optional<int> wait_for(pid_t child, double max_seconds) {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::duration<double>(max_seconds);
    const Descriptor handle(static_cast<int>(syscall(SYS_pidfd_open, child, 0)));
    bool in_time = true;
    for (bool ended = false; !ended && in_time;) {
        const auto left =
            std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
        in_time = left > 0;
        // Without a handle (Linux before 5.3) it asks again and again.
        const int step = static_cast<int>(std::min<long>(left, handle.get() < 0 ? 10 : 1000));
        pollfd wanted{handle.get(), POLLIN, 0};
        if (in_time) poll(&wanted, handle.get() < 0 ? 0 : 1, step);
        siginfo_t info{};
        ended = waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
                info.si_pid == child;
    }
    if (!in_time) kill(child, SIGKILL);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return in_time ? std::optional(status) : std::nullopt;
}

class MappedResult {
public:
    explicit MappedResult(int descriptor) {
        const off_t size = lseek(descriptor, 0, SEEK_END);
        size_ = size > 0 ? static_cast<std::size_t>(size) : 0;
        if (size_ == 0) return;
        address_ = mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, descriptor, 0);
        if (address_ == MAP_FAILED) throw std::bad_alloc();
    }
    ~MappedResult() {
        if (size_ > 0) munmap(address_, size_);
    }
    MappedResult(const MappedResult&) = delete;
    MappedResult& operator=(const MappedResult&) = delete;

    [[nodiscard]] std::span<const std::byte> bytes() const {
        return {static_cast<const std::byte*>(address_), size_};
    }

private:
    void* address_ = nullptr;
    std::size_t size_ = 0;
};

}  // namespace

Scene read_in_child(const std::filesystem::path& file, const std::function<Scene()>& read,
                    std::uint64_t max_bytes, double max_seconds) {
    const Descriptor result(memfd_create("octavo-scene", MFD_CLOEXEC));
    if (result.get() < 0) throw io_error(file, "read");
    const std::uint64_t max_address_space = address_space_bytes() + max_bytes;
    const pid_t child = fork();
    if (child < 0) throw io_error(file, "start a process to read");
    if (child == 0) run_child(result.get(), read, max_address_space);

    const std::optional<int> status = wait_for(child, max_seconds);
    if (!status)
        throw Error(Errc::limit, file,
                    "not read after " + std::to_string(static_cast<long>(max_seconds)) +
                        " s: convert it to glTF, PLY, OBJ or STL");
    if (WIFSIGNALED(*status))
        throw Error(Errc::bad_input, file,
                    "the library that reads this format has crashed (signal " +
                        std::to_string(WTERMSIG(*status)) + "): the file is damaged or unusual");
    const int code = WEXITSTATUS(*status);
    const MappedResult written(result.get());
    if (code == kDone) return read_scene_bytes(written.bytes());
    if (code == kOutOfMemory) throw std::bad_alloc();
    const auto text = written.bytes();
    std::string message(reinterpret_cast<const char*>(text.data()), text.size());
    const std::string prefix = file.string() + ": ";
    if (message.starts_with(prefix)) message.erase(0, prefix.size());
    if (code - kFailed > static_cast<int>(Errc::unsupported))
        throw Error(Errc::bad_input, file, "the library that reads this format has failed");
    throw Error(static_cast<Errc>(code - kFailed), file, message);
}

}  // namespace octavo
