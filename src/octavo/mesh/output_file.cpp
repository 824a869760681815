// SPDX-License-Identifier: MIT
#include "octavo/mesh/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <string>

#include "octavo/core/error.h"

namespace octavo {

OutputFile::OutputFile(const std::filesystem::path& file)
    : file_(file),
      temporary_(file.string() + ".part-" + std::to_string(::getpid())),
      buffer_(std::make_unique_for_overwrite<char[]>(kCapacity)) {
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor_ < 0) throw io_error(file_, "create");
}

OutputFile::~OutputFile() {
    if (descriptor_ >= 0) {
        ::close(descriptor_);
        ::unlink(temporary_.c_str());
    }
}

void OutputFile::write_large(const void* data, std::size_t size) {
    flush();
    const char* at = static_cast<const char*>(data);
    for (; size > kCapacity; at += kCapacity, size -= kCapacity) {
        std::memcpy(buffer_.get(), at, kCapacity);
        used_ = kCapacity;
        flush();
    }
    write(at, size);
}

void OutputFile::flush() {
    const char* at = buffer_.get();
    while (used_ > 0) {
        const ssize_t count = ::write(descriptor_, at, used_);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) throw io_error(file_, "write");
        at += count;
        used_ -= static_cast<std::size_t>(count);
    }
}

void OutputFile::commit() {
    flush();
    if (::fsync(descriptor_) != 0) throw io_error(file_, "write");
    if (::rename(temporary_.c_str(), file_.c_str()) != 0) throw io_error(file_, "rename");
    ::close(descriptor_);
    descriptor_ = -1;
}

}  // namespace octavo
