// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "octavo/core/vec.h"

namespace octavo::gltf {

/// The numbers of an accessor, read one at a time where they lie. All bounds were checked when it
/// was made, so reading below `count` cannot fail.
class Accessor {
public:
    enum ComponentType { kI8 = 5120, kU8, kI16, kU16, kU32 = 5125, kF32 };
    /// In bytes; 0 of a type that is not in the list.
    [[nodiscard]] static std::size_t component_size(int type);

    Accessor() = default;
    /// Values of its own, one element after the other.
    Accessor(std::vector<std::byte> values, int component_type, int components, bool normalized);

    std::size_t count = 0;
    int components = 1;  // 1 to 4; matrices are not read

    /// Element i, normalized where the accessor says so; components that it does not have are 0.
    [[nodiscard]] dvec4 real(std::size_t i) const;
    /// Element i of an accessor of unsigned integers.
    [[nodiscard]] std::uint32_t index(std::size_t i) const;

private:
    friend class Document;
    [[nodiscard]] std::size_t element_size() const;

    const std::byte* data_ = nullptr;
    std::size_t stride_ = 0;
    int component_type_ = 0;
    bool normalized_ = false;
    std::shared_ptr<std::vector<std::byte>> own_;  // where the values are not in the document
};

}  // namespace octavo::gltf
