// SPDX-License-Identifier: MIT
#include "octavo/io/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>

#include "octavo/core/error.h"

namespace octavo {
namespace {

class OpenFile {
public:
    explicit OpenFile(const std::filesystem::path& path)
        // Without O_NONBLOCK, opening a named pipe would wait for a writer for ever.
        : descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
        struct stat status {};
        if (descriptor_ < 0 || fstat(descriptor_, &status) != 0) throw io_error(path, "read");
        if (!S_ISREG(status.st_mode)) {
            close(descriptor_);
            throw Error(Errc::io, path, "cannot read: it is not a regular file");
        }
        size_ = static_cast<std::size_t>(status.st_size);
    }
    ~OpenFile() { close(descriptor_); }
    OpenFile(const OpenFile&) = delete;
    OpenFile& operator=(const OpenFile&) = delete;

    [[nodiscard]] int descriptor() const { return descriptor_; }
    [[nodiscard]] std::size_t size() const { return size_; }

private:
    int descriptor_;
    std::size_t size_ = 0;
};

}  // namespace

Mapping::~Mapping() {
    if (size_ > 0) munmap(address_, size_);
}

std::shared_ptr<const Mapping> map_file(const std::filesystem::path& path) {
    const OpenFile file(path);
    if (file.size() == 0) return std::make_shared<Mapping>(nullptr, 0);
    void* address = mmap(nullptr, file.size(), PROT_READ, MAP_PRIVATE, file.descriptor(), 0);
    if (address == MAP_FAILED) throw io_error(path, "map");
    return std::make_shared<Mapping>(address, file.size());
}

std::shared_ptr<const Mapping> copy_file_to_memory(const std::filesystem::path& path) {
    const OpenFile file(path);
    std::shared_ptr<Mapping> memory = allocate_mapping(file.size());
    std::span<std::byte> rest = memory->writable_bytes();
    while (!rest.empty()) {
        const ssize_t count = read(file.descriptor(), rest.data(), rest.size());
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) throw io_error(path, "read");
        if (count == 0) throw Error(Errc::io, path, "cannot read: it became shorter meanwhile");
        rest = rest.subspan(static_cast<std::size_t>(count));
    }
    return memory;
}

std::shared_ptr<Mapping> allocate_mapping(std::uint64_t size_bytes) {
    if (size_bytes == 0) return std::make_shared<Mapping>(nullptr, 0);
    void* address = mmap(nullptr, size_bytes, PROT_READ | PROT_WRITE,
                         MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (address == MAP_FAILED)
        throw Error(Errc::limit, "no memory for " + std::to_string(size_bytes) + " bytes");
    return std::make_shared<Mapping>(address, size_bytes);
}

}  // namespace octavo
