// SPDX-License-Identifier: MIT
//
// The container of glTF 2.0 (Khronos Group, 2017). Our own reader over a JSON library because
// tinygltf follows offsets from the file without checking them, and reads whatever a URI names.
#include "octavo/mesh/gltf_document.h"

#include <cstring>

#include "octavo/mesh/confined_path.h"
#include "octavo/mesh/gltf_meshopt.h"
#include "octavo/mesh/text_cursor.h"

namespace octavo::gltf {
namespace {

int component_count(const std::string& type) {
    if (type == "SCALAR") return 1;
    if (type == "VEC2") return 2;
    if (type == "VEC3") return 3;
    if (type == "VEC4") return 4;
    return 0;
}

std::uint32_t little_endian_word(std::string_view bytes, std::size_t at) {
    std::uint32_t word = 0;
    std::memcpy(&word, bytes.data() + at, sizeof word);
    return word;
}

std::span<const std::byte> as_bytes(std::string_view text) {
    return {reinterpret_cast<const std::byte*>(text.data()), text.size()};
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

bool Document::names(const std::string& extension) const {
    for (const char* list : {"extensionsUsed", "extensionsRequired"})
        if (const json* all = child(root_, list))
            for (const json& name : *all)
                if (name == extension) return true;
    return false;
}

std::span<const std::byte> Document::part(const json& view, const std::string& whose) {
    const std::span<const std::byte> bytes = buffer(whole(view, "buffer").value_or(0));
    const std::size_t offset = whole(view, "byteOffset").value_or(0);
    const std::size_t length = whole(view, "byteLength").value_or(0);
    if (offset > bytes.size() || length > bytes.size() - offset)
        throw file_.error(whose + " reaches past its buffer");
    return bytes.subspan(offset, length);
}

std::span<const std::byte> Document::buffer_view(std::size_t index) {
    const json& view = object("bufferViews", index);
    const std::string name = "bufferView " + std::to_string(index);
    const json* packing = meshopt_packing(view);
    if (!packing) return part(view, name);
    auto known = unpacked_views_.find(index);
    if (known == unpacked_views_.end()) {
        auto bytes = unpack_meshopt(*packing, part(*packing, name), file_, buffer_bytes_left_);
        buffer_bytes_left_ -= bytes.size();
        known = unpacked_views_.emplace(index, std::move(bytes)).first;
    }
    return known->second;
}

std::optional<Accessor> Document::unpack_draco(const json& primitive) {
    const json* packing = names(kDraco) ? extension(primitive, kDraco) : nullptr;
    const json* packed = packing ? child(*packing, "attributes") : nullptr;
    const json* attributes = child(primitive, "attributes");
    if (!packed || !attributes) return {};
    if (const auto position = whole(*attributes, "POSITION"))
        if (child(object("accessors", *position), "bufferView")) return {};

    const std::size_t view = whole(*packing, "bufferView").value_or(count("bufferViews"));
    auto mesh = draco_meshes_.find(view);
    if (mesh == draco_meshes_.end())
        mesh = draco_meshes_.emplace(view, DracoMesh(buffer_view(view), file_)).first;
    for (const auto& [name, id] : packed->items()) {
        const auto accessor = whole(*attributes, name.c_str());
        if (!accessor) continue;
        const DracoAttribute source{view, static_cast<std::uint32_t>(as_whole(id))};
        if (draco_attributes_.emplace(*accessor, source).first->second != source)
            throw file_.error("accessor " + std::to_string(*accessor) + " is packed twice");
    }
    return mesh->second.triangles();
}

Accessor Document::accessor(std::size_t index) {
    const json& description = object("accessors", index);
    const auto fail = [&](const std::string& what) {
        return file_.error("accessor " + std::to_string(index) + " " + what);
    };
    if (const auto packed = draco_attributes_.find(index); packed != draco_attributes_.end())
        return draco_meshes_.at(packed->second.view)
            .attribute(packed->second.id, value_or(description, "normalized", false));

    Accessor accessor;
    accessor.count = whole(description, "count").value_or(0);
    accessor.component_type_ = static_cast<int>(whole(description, "componentType").value_or(0));
    accessor.components = component_count(value_or<std::string>(description, "type", ""));
    accessor.normalized_ = value_or(description, "normalized", false);
    const std::size_t size = accessor.element_size();
    if (size == 0) throw fail("has a type that cannot be read");
    accessor.stride_ = size;

    if (const auto view_index = whole(description, "bufferView")) {
        const std::span<const std::byte> bytes = buffer_view(*view_index);
        const json& view = object("bufferViews", *view_index);
        accessor.stride_ = whole(view, "byteStride").value_or(size);
        const std::size_t offset = whole(description, "byteOffset").value_or(0);
        const std::size_t room = offset > bytes.size() ? 0 : bytes.size() - offset;
        if (accessor.stride_ < size) throw fail("has a stride below its element's size");
        if (accessor.count > 0 &&
            (room < size || accessor.count - 1 > (room - size) / accessor.stride_))
            throw fail("reaches past its bufferView");
        accessor.data_ = bytes.data() + offset;
    } else {
        // Zeros, of which a short file could ask for any number.
        if (accessor.count > file_.view().size() + (1u << 20)) throw fail("has no data");
        accessor = Accessor(std::vector<std::byte>(accessor.count * size), accessor.component_type_,
                            accessor.components, accessor.normalized_);
    }
    if (const json* sparse = child(description, "sparse")) apply_sparse(*sparse, accessor);
    return accessor;
}

void Document::apply_sparse(const json& sparse, Accessor& accessor) {
    const std::size_t count = whole(sparse, "count").value_or(0);
    const std::size_t element_size = accessor.element_size();
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
    indices.stride_ = indices.element_size();
    if (indices.stride_ == 0) throw file_.error("a sparse accessor has indices of unknown type");
    indices.data_ = part("indices", indices.stride_).data();
    const std::span<const std::byte> values = part("values", element_size);

    if (!accessor.own_) {
        std::vector<std::byte> copy(accessor.count * element_size);
        for (std::size_t i = 0; i < accessor.count; ++i)
            std::memcpy(copy.data() + i * element_size, accessor.data_ + i * accessor.stride_,
                        element_size);
        accessor = Accessor(std::move(copy), accessor.component_type_, accessor.components,
                            accessor.normalized_);
    }
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t at = indices.index(i);
        if (at >= accessor.count) throw file_.error("a sparse accessor's index is out of range");
        std::memcpy(accessor.own_->data() + at * element_size, values.data() + i * element_size,
                    element_size);
    }
}

}  // namespace octavo::gltf
