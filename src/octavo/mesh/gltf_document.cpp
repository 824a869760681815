// SPDX-License-Identifier: MIT
//
// The container of glTF 2.0 (Khronos Group, 2017). Our own reader over a JSON library because
// tinygltf follows offsets from the file without checking them, and reads whatever a URI names.
#include "octavo/mesh/gltf_document.h"

#include <cmath>
#include <cstring>

#include "octavo/mesh/confined_path.h"
#include "octavo/mesh/text_cursor.h"

namespace octavo::gltf {
namespace {

enum ComponentType { kI8 = 5120, kU8, kI16, kU16, kU32 = 5125, kF32 = 5126 };

std::size_t component_size(int type) {
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

int component_count(const std::string& type) {
    if (type == "SCALAR") return 1;
    if (type == "VEC2") return 2;
    if (type == "VEC3") return 3;
    if (type == "VEC4") return 4;
    return 0;
}

template <class T>
T take(const std::byte* from) {
    T value;
    std::memcpy(&value, from, sizeof(T));
    return value;
}

std::uint32_t little_endian_word(std::string_view bytes, std::size_t at) {
    return take<std::uint32_t>(reinterpret_cast<const std::byte*>(bytes.data() + at));
}

std::span<const std::byte> as_bytes(std::string_view text) {
    return {reinterpret_cast<const std::byte*>(text.data()), text.size()};
}

int base64_digit(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    if (c == '+') return 62;
    return c == '/' ? 63 : -1;
}

/// "2.0"; empty where the file does not say.
std::string asset_version(const json& root) {
    const json* asset = child(root, "asset");
    const json* version = asset && asset->is_object() ? child(*asset, "version") : nullptr;
    return version && version->is_string() ? version->get<std::string>() : std::string();
}

Error other_version(const std::filesystem::path& file, const std::string& version) {
    return {Errc::unsupported, file, "is glTF " + version + ": convert it to glTF 2.0"};
}

}  // namespace

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

Document::Document(const FileBytes& bytes, std::uint64_t max_bytes)
    : file_(bytes), buffer_bytes_left_(max_bytes) {
    const std::string_view view = bytes.view();
    std::string_view text = view;
    if (view.starts_with("glTF")) {
        constexpr std::size_t kHeaderSize = 12, kChunkHeaderSize = 8;
        constexpr std::uint32_t kJson = 0x4e4f534a, kBinary = 0x004e4942;
        if (view.size() < kHeaderSize + kChunkHeaderSize)
            throw bytes.error_at(view.data() + view.size(), "is too short for a GLB file");
        if (const std::uint32_t version = little_endian_word(view, 4); version != 2)
            throw other_version(bytes.file(), std::to_string(version));
        text = {};
        for (std::size_t at = kHeaderSize; at + kChunkHeaderSize <= view.size();) {
            const std::size_t size = little_endian_word(view, at);
            const std::uint32_t kind = little_endian_word(view, at + 4);
            const std::size_t first = at + kChunkHeaderSize;
            if (size > view.size() - first)
                throw bytes.error_at(view.data() + at, "a chunk is longer than the file");
            if (kind == kJson && text.empty()) text = view.substr(first, size);
            if (kind == kBinary && !glb_chunk_) glb_chunk_ = as_bytes(view.substr(first, size));
            at = first + size;
        }
    }
    text = without_byte_order_mark(text);
    try {
        root_ = json::parse(text.begin(), text.end());
    } catch (const json::parse_error& error) {
        throw bytes.error_at(text.data() + (error.byte == 0 ? 0 : error.byte - 1),
                             "its JSON is malformed");
    }
    if (!root_.is_object()) throw bytes.error("its JSON is not an object");
    if (const std::string version = asset_version(root_);
        !version.empty() && version != "2" && !version.starts_with("2."))
        throw other_version(bytes.file(), version);
}

std::size_t Document::count(const char* name) const {
    const auto found = root_.find(name);
    return found == root_.end() || !found->is_array() ? 0 : found->size();
}

const json& Document::object(const char* name, std::size_t index) const {
    if (index < count(name)) {
        const json& found = root_[name][index];
        if (found.is_object()) return found;
    }
    throw file_.error(std::string(name) + " has no object " + std::to_string(index));
}

std::span<const std::byte> Document::buffer(std::size_t index) {
    const json& description = object("buffers", index);
    const json* uri_value = child(description, "uri");
    if (!uri_value) {
        if (index == 0 && glb_chunk_) return *glb_chunk_;
        throw file_.error("buffer " + std::to_string(index) + " has no data");
    }
    const auto& uri = uri_value->get_ref<const std::string&>();
    if (const auto known = inline_buffers_.find(index); known != inline_buffers_.end())
        return known->second;
    if (auto data = data_uri(uri))
        return inline_buffers_.emplace(index, std::move(*data)).first->second;

    const auto path = confined_path(folder_of(file_.file()), percent_decoded(uri));
    if (!path) throw file_.error("the buffer '" + uri + "' is outside the scene's folder");
    auto known = buffer_files_.find(*path);
    if (known == buffer_files_.end()) {
        std::error_code unknown;
        if (!std::filesystem::exists(*path, unknown))
            throw file_.error("the buffer '" + uri + "' does not exist");
        known = buffer_files_.emplace(*path, read_file(*path, buffer_bytes_left_)).first;
        buffer_bytes_left_ -= known->second.view().size();
    }
    return as_bytes(known->second.view());
}

std::span<const std::byte> Document::buffer_view(std::size_t index) {
    const json& view = object("bufferViews", index);
    const std::span<const std::byte> bytes = buffer(whole(view, "buffer").value_or(0));
    const std::size_t offset = whole(view, "byteOffset").value_or(0);
    const std::size_t length = whole(view, "byteLength").value_or(0);
    if (offset > bytes.size() || length > bytes.size() - offset)
        throw file_.error("bufferView " + std::to_string(index) + " reaches past its buffer");
    return bytes.subspan(offset, length);
}

Accessor Document::accessor(std::size_t index) {
    const json& description = object("accessors", index);
    const auto fail = [&](const std::string& what) {
        return file_.error("accessor " + std::to_string(index) + " " + what);
    };
    Accessor accessor;
    accessor.count = whole(description, "count").value_or(0);
    accessor.component_type_ = static_cast<int>(whole(description, "componentType").value_or(0));
    accessor.components = component_count(value_or<std::string>(description, "type", ""));
    accessor.normalized_ = value_or(description, "normalized", false);
    const std::size_t element_size =
        component_size(accessor.component_type_) * static_cast<std::size_t>(accessor.components);
    if (element_size == 0) throw fail("has a type that cannot be read");
    accessor.stride_ = element_size;

    const json* sparse = child(description, "sparse");
    if (const auto view_index = whole(description, "bufferView")) {
        const std::span<const std::byte> bytes = buffer_view(*view_index);
        const json& view = object("bufferViews", *view_index);
        accessor.stride_ = whole(view, "byteStride").value_or(element_size);
        const std::size_t offset = whole(description, "byteOffset").value_or(0);
        const std::size_t room = offset > bytes.size() ? 0 : bytes.size() - offset;
        if (accessor.stride_ < element_size) throw fail("has a stride below its element's size");
        if (accessor.count > 0 &&
            (room < element_size || accessor.count - 1 > (room - element_size) / accessor.stride_))
            throw fail("reaches past its bufferView");
        accessor.data_ = bytes.data() + offset;
    } else {
        // Zeros, of which a short file could ask for any number.
        if (accessor.count > file_.view().size() + (1u << 20)) throw fail("has no data");
        accessor.patched_ = std::make_shared<std::vector<std::byte>>(accessor.count * element_size);
        accessor.data_ = accessor.patched_->data();
    }
    if (sparse) apply_sparse(*sparse, element_size, accessor);
    return accessor;
}

void Document::apply_sparse(const json& sparse, std::size_t element_size, Accessor& accessor) {
    const std::size_t count = whole(sparse, "count").value_or(0);
    const auto part = [&](const char* name, std::size_t size) {
        const json* description = child(sparse, name);
        const auto view = description ? whole(*description, "bufferView") : std::nullopt;
        if (!view) throw file_.error("a sparse accessor has no " + std::string(name));
        const std::span<const std::byte> bytes = buffer_view(*view);
        const std::size_t offset = whole(*description, "byteOffset").value_or(0);
        if (offset > bytes.size() || count > (bytes.size() - offset) / size)
            throw file_.error("a sparse accessor reaches past its bufferView");
        return bytes.subspan(offset);
    };
    Accessor indices;
    const json* description = child(sparse, "indices");
    if (description)
        indices.component_type_ =
            static_cast<int>(whole(*description, "componentType").value_or(0));
    indices.stride_ = component_size(indices.component_type_);
    if (indices.stride_ == 0) throw file_.error("a sparse accessor has indices of unknown type");
    indices.data_ = part("indices", indices.stride_).data();
    const std::span<const std::byte> values = part("values", element_size);

    if (!accessor.patched_) {
        auto copy = std::make_shared<std::vector<std::byte>>(accessor.count * element_size);
        for (std::size_t i = 0; i < accessor.count; ++i)
            std::memcpy(copy->data() + i * element_size, accessor.data_ + i * accessor.stride_,
                        element_size);
        accessor.patched_ = std::move(copy);
        accessor.data_ = accessor.patched_->data();
        accessor.stride_ = element_size;
    }
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t at = indices.index(i);
        if (at >= accessor.count) throw file_.error("a sparse accessor's index is out of range");
        std::memcpy(accessor.patched_->data() + at * element_size, values.data() + i * element_size,
                    element_size);
    }
}

std::size_t as_whole(const json& value) {
    const double number = value.get<double>();
    if (!(number >= 0.0 && number <= 0x1p53 && number == std::floor(number)))
        throw json::other_error::create(500, "an index or a size is not a whole number", nullptr);
    return static_cast<std::size_t>(number);
}

std::optional<std::size_t> whole(const json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end()) return {};
    return as_whole(*found);
}

const json* child(const json& object, const char* key) {
    const auto found = object.find(key);
    return found == object.end() ? nullptr : &*found;
}

const json* extension(const json& object, const char* name) {
    const json* extensions = child(object, "extensions");
    return extensions && extensions->is_object() ? child(*extensions, name) : nullptr;
}

dvec4 numbers(const json& object, const char* key, const dvec4& fallback) {
    const json* array = child(object, key);
    if (!array) return fallback;
    dvec4 value = fallback;
    for (std::size_t i = 0; i < array->size() && i < 4; ++i)
        value[static_cast<int>(i)] = array->at(i).get<double>();
    return value;
}

std::optional<std::vector<std::byte>> data_uri(std::string_view uri) {
    if (!uri.starts_with("data:")) return {};
    const std::size_t comma = uri.find(',');
    std::vector<std::byte> bytes;
    if (comma == std::string_view::npos || !uri.substr(0, comma).ends_with(";base64")) return bytes;
    std::uint32_t bits = 0;
    int have = 0;
    bytes.reserve((uri.size() - comma) / 4 * 3);
    for (const char c : uri.substr(comma + 1)) {
        const int digit = base64_digit(c);
        if (digit < 0) break;  // the padding
        bits = bits << 6 | static_cast<std::uint32_t>(digit);
        have += 6;
        if (have >= 8) {
            have -= 8;
            bytes.push_back(static_cast<std::byte>(bits >> have & 0xff));
        }
    }
    return bytes;
}

}  // namespace octavo::gltf
