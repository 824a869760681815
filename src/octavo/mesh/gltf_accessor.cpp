// SPDX-License-Identifier: MIT
#include "octavo/mesh/gltf_accessor.h"

#include <cstring>

namespace octavo::gltf {
namespace {

template <class T>
T take(const std::byte* from) {
    T value;
    std::memcpy(&value, from, sizeof(T));
    return value;
}

}  // namespace

std::size_t Accessor::component_size(int type) {
    switch (type) {
        case kI8:
        case kU8:
            return 1;
        case kI16:
        case kU16:
            return 2;
        case kU32:
        case kF32:
            return 4;
        default:
            return 0;
    }
}

Accessor::Accessor(std::vector<std::byte> values, int component_type, int element_components,
                   bool normalized)
    : components(element_components), component_type_(component_type), normalized_(normalized) {
    stride_ = element_size();
    count = values.size() / stride_;
    own_ = std::make_shared<std::vector<std::byte>>(std::move(values));
    data_ = own_->data();
}

std::size_t Accessor::element_size() const {
    return component_size(component_type_) * static_cast<std::size_t>(components);
}

dvec4 Accessor::real(std::size_t i) const {
    const std::byte* at = data_ + i * stride_;
    dvec4 value{0.0};
    for (int c = 0; c < components; ++c) {
        const auto index = static_cast<std::size_t>(c);
        switch (component_type_) {
            case kF32:
                value[c] = take<float>(at + 4 * index);
                break;
            case kU32:
                value[c] = take<std::uint32_t>(at + 4 * index);
                break;
            case kU16:
                value[c] = take<std::uint16_t>(at + 2 * index);
                break;
            case kI16:
                value[c] = take<std::int16_t>(at + 2 * index);
                break;
            case kU8:
                value[c] = take<std::uint8_t>(at + index);
                break;
            default:
                value[c] = take<std::int8_t>(at + index);
                break;
        }
    }
    if (!normalized_) return value;
    switch (component_type_) {
        case kU8:
            return value / 255.0;
        case kU16:
            return value / 65535.0;
        case kI8:
            return glm::max(value / 127.0, dvec4(-1.0));
        case kI16:
            return glm::max(value / 32767.0, dvec4(-1.0));
        default:
            return value;
    }
}

std::uint32_t Accessor::index(std::size_t i) const {
    const std::byte* at = data_ + i * stride_;
    switch (component_type_) {
        case kU8:
            return take<std::uint8_t>(at);
        case kU16:
            return take<std::uint16_t>(at);
        default:
            return take<std::uint32_t>(at);
    }
}

}  // namespace octavo::gltf
