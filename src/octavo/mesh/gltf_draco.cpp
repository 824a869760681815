// SPDX-License-Identifier: MIT
//
// KHR_draco_mesh_compression (Khronos Group, 2017), by the library that defines the codec.
#include "octavo/mesh/gltf_draco.h"

#include <draco/compression/decode.h>

#include <span>
#include <string>
#include <vector>

namespace octavo::gltf {
namespace {

/// The type that an accessor of these values has; 0 where it can have none.
int component_type(draco::DataType type) {
    switch (type) {
        case draco::DT_INT8:
            return Accessor::kI8;
        case draco::DT_UINT8:
            return Accessor::kU8;
        case draco::DT_INT16:
            return Accessor::kI16;
        case draco::DT_UINT16:
            return Accessor::kU16;
        case draco::DT_UINT32:
            return Accessor::kU32;
        case draco::DT_FLOAT32:
            return Accessor::kF32;
        default:
            return 0;
    }
}

}  // namespace

DracoMesh::DracoMesh(std::span<const std::byte> packed, const FileBytes& file) : file_(file) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(packed.data()), packed.size());
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok())
        throw file.error("has Draco data that cannot be read: " +
                         decoded.status().error_msg_string());
    mesh_ = std::move(decoded).value();
}

Accessor DracoMesh::triangles() const {
    std::vector<std::uint32_t> corners;
    corners.reserve(std::size_t{3} * mesh_->num_faces());
    for (std::uint32_t i = 0; i < mesh_->num_faces(); ++i)
        for (const draco::PointIndex& corner : mesh_->face(draco::FaceIndex(i)))
            corners.push_back(corner.value());
    const auto bytes = std::as_bytes(std::span(corners));
    std::vector<std::byte> values(bytes.begin(), bytes.end());
    return {std::move(values), Accessor::kU32, 1, false};
}

Accessor DracoMesh::attribute(std::uint32_t id, bool normalized) const {
    const draco::PointAttribute* source = mesh_->GetAttributeByUniqueId(id);
    if (!source) throw file_.error("has Draco data without attribute " + std::to_string(id));
    const int type = component_type(source->data_type());
    const int components = source->num_components();
    if (type == 0 || components < 1 || components > 4)
        throw file_.error("has Draco data of a type that cannot be read");
    const std::size_t size = Accessor::component_size(type) * static_cast<std::size_t>(components);
    std::vector<std::byte> values(std::size_t{mesh_->num_points()} * size);
    for (std::uint32_t i = 0; i < mesh_->num_points(); ++i) {
        const draco::AttributeValueIndex at = source->mapped_index(draco::PointIndex(i));
        if (at.value() >= source->size()) throw file_.error("has damaged Draco data");
        std::memcpy(values.data() + i * size, source->GetAddress(at), size);
    }
    return {std::move(values), type, components, normalized};
}

}  // namespace octavo::gltf
