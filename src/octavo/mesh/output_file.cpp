// SPDX-License-Identifier: MIT
#include "octavo/mesh/output_file.h"

#include <span>

namespace octavo {

OutputFile::OutputFile(const std::filesystem::path& file)
    : file_(file), buffer_(std::make_unique_for_overwrite<char[]>(kCapacity)) {}

void OutputFile::write_large(const void* data, std::size_t size) {
    flush();
    if (size <= kCapacity) return write(data, size);
    file_.write(size_bytes_, {static_cast<const std::byte*>(data), size});
    size_bytes_ += size;
}

void OutputFile::flush() {
    file_.write(size_bytes_, std::as_bytes(std::span(buffer_.get(), used_)));
    size_bytes_ += used_;
    used_ = 0;
}

void OutputFile::commit() {
    flush();
    file_.commit();
}

}  // namespace octavo
