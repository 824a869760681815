// SPDX-License-Identifier: MIT
//
// Binary glTF 2.0. The JSON needs every size before the first byte of data is written, and all
// sizes follow from counts, so the data is streamed once.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "octavo/core/file_bytes.h"
#include "octavo/mesh/output_file.h"
#include "octavo/mesh/save_formats.h"

namespace octavo {
namespace {

using json = nlohmann::ordered_json;

enum ComponentType { kU8 = 5121, kU32 = 5125, kF32 = 5126 };

json array_of(const vec3& v) {
    return {v.x, v.y, v.z};
}
json array_of(const dvec3& v) {
    return {v.x, v.y, v.z};
}

/// A node's matrix for what looks along -z: a camera or a lamp.
json looking(const dvec3& position, const dvec3& forward, const dvec3& up) {
    const dvec3 right = glm::normalize(glm::cross(forward, up));
    const dvec3 top = glm::cross(right, forward);
    return {right.x,    right.y,    right.z,    0.0, top.x,      top.y,      top.z,      0.0,
            -forward.x, -forward.y, -forward.z, 0.0, position.x, position.y, position.z, 1.0};
}

/// Any direction that is not nearly the given one.
dvec3 some_up(const dvec3& forward) {
    return std::abs(forward.y) < 0.9 ? dvec3(0.0, 1.0, 0.0) : dvec3(0.0, 0.0, 1.0);
}

std::string_view picture_type(std::string_view bytes) {
    return bytes.starts_with("\x89PNG") ? "image/png" : "image/jpeg";
}

int wrap_code(Texture::Wrap wrap) {
    constexpr int kRepeat = 10497, kClampToEdge = 33071, kMirroredRepeat = 33648;
    return wrap == Texture::Wrap::clamp    ? kClampToEdge
           : wrap == Texture::Wrap::mirror ? kMirroredRepeat
                                           : kRepeat;
}

class GlbWriter {
public:
    GlbWriter(const Scene& scene, const std::filesystem::path& file) : scene_(scene), file_(file) {
        if (!formats::floats_are_exact(scene)) {
            const Box bounds = scene.bounds();
            if (!bounds.empty()) origin_ = bounds.centre();
        }
        sort_by_material();
    }

    void write() {
        describe_mesh();
        describe_materials();
        describe_pictures();
        describe_cameras_and_lights();
        root_["buffers"] = {{{"byteLength", size_}}};
        if (!extensions_.empty()) root_["extensionsUsed"] = extensions_;

        std::string text = root_.dump();
        text.resize((text.size() + 3) / 4 * 4, ' ');
        constexpr std::uint64_t kHeaders = 12 + 8 + 8;
        if (kHeaders + text.size() + size_ > std::numeric_limits<std::uint32_t>::max())
            throw Error(Errc::limit, file_, "is too large for GLB (4 GiB): write .ply or .obj");

        OutputFile out(file_);
        const auto word = [&](std::uint64_t value) {
            out.write_raw(static_cast<std::uint32_t>(value));
        };
        out.write("glTF");
        word(2);
        word(kHeaders + text.size() + size_);
        word(text.size());
        out.write("JSON");
        out.write(text);
        word(size_);
        out.write(std::string_view("BIN\0", 4));
        write_data(out);
        out.commit();
    }

private:
    /// The first triangle of each material's run in order_; the last run has no material.
    void sort_by_material() {
        const std::size_t groups = scene_.materials.size() + 1;
        starts_.assign(groups + 1, 0);
        if (scene_.triangle_materials.empty()) {
            starts_.back() = scene_.triangles.size();
            return;
        }
        const auto group_of = [&](std::size_t i) {
            return std::min<std::size_t>(scene_.triangle_materials[i], groups - 1);
        };
        for (std::size_t i = 0; i < scene_.triangles.size(); ++i) ++starts_[group_of(i) + 1];
        for (std::size_t g = 0; g < groups; ++g) starts_[g + 1] += starts_[g];
        std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
        order_.resize(scene_.triangles.size());
        for (std::size_t i = 0; i < scene_.triangles.size(); ++i)
            order_[next[group_of(i)]++] = static_cast<std::uint32_t>(i);
    }

    std::size_t add_view(std::uint64_t bytes) {
        root_["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", size_}, {"byteLength", bytes}});
        size_ += (bytes + 3) / 4 * 4;
        return root_["bufferViews"].size() - 1;
    }

    std::size_t add_accessor(std::size_t view, int component, std::size_t count, const char* type,
                             std::uint64_t offset = 0) {
        root_["accessors"].push_back({{"bufferView", view},
                                      {"byteOffset", offset},
                                      {"componentType", component},
                                      {"count", count},
                                      {"type", type}});
        return root_["accessors"].size() - 1;
    }

    void describe_mesh() {
        root_["asset"] = {{"version", "2.0"}, {"generator", "octavo"}};
        const std::size_t count = scene_.positions.size();
        json attributes;
        const std::size_t position = add_accessor(add_view(12 * count), kF32, count, "VEC3");
        attributes["POSITION"] = position;
        vec3 low(0.0f), high(0.0f);
        bool first = true;
        for (const dvec3& p : scene_.positions) {
            const vec3 q(p - origin_);
            if (!std::isfinite(q.x + q.y + q.z)) continue;
            low = first ? q : glm::min(low, q);
            high = first ? q : glm::max(high, q);
            first = false;
        }
        root_["accessors"][position]["min"] = array_of(low);
        root_["accessors"][position]["max"] = array_of(high);
        if (!scene_.texture_coordinates.empty())
            attributes["TEXCOORD_0"] = add_accessor(add_view(8 * count), kF32, count, "VEC2");
        if (!scene_.emission_coordinates.empty())
            attributes["TEXCOORD_1"] = add_accessor(add_view(8 * count), kF32, count, "VEC2");
        if (!scene_.colors.empty()) {
            const std::size_t color = add_accessor(add_view(4 * count), kU8, count, "VEC4");
            root_["accessors"][color]["normalized"] = true;
            attributes["COLOR_0"] = color;
        }

        json primitives = json::array();
        const std::size_t indices = add_view(12 * scene_.triangles.size());
        for (std::size_t g = 0; g + 1 < starts_.size(); ++g) {
            const std::size_t triangles = starts_[g + 1] - starts_[g];
            if (triangles == 0) continue;
            json primitive{{"attributes", attributes}};
            primitive["indices"] =
                add_accessor(indices, kU32, 3 * triangles, "SCALAR", 12 * starts_[g]);
            if (g < scene_.materials.size()) primitive["material"] = g;
            primitives.push_back(std::move(primitive));
        }
        root_["meshes"] = {{{"primitives", std::move(primitives)}}};
        json node{{"mesh", 0}};
        if (origin_ != dvec3(0.0)) node["translation"] = array_of(origin_);
        add_node(std::move(node));
        root_["scene"] = 0;
    }

    void add_node(json node) {
        root_["nodes"].push_back(std::move(node));
        root_["scenes"][0]["nodes"].push_back(root_["nodes"].size() - 1);
    }

    void use_extension(const char* name) {
        if (std::find(extensions_.begin(), extensions_.end(), name) == extensions_.end())
            extensions_.emplace_back(name);
    }

    void describe_materials() {
        for (const Material& material : scene_.materials) {
            json target{{"name", material.name}, {"doubleSided", true}};
            const vec4& c = material.base_color;
            json& pbr = target["pbrMetallicRoughness"];
            pbr["baseColorFactor"] = {c.r, c.g, c.b, c.a};
            pbr["metallicFactor"] = 0.0;
            if (material.base_color_texture != Material::kNoTexture)
                pbr["baseColorTexture"] = {{"index", material.base_color_texture}};
            const vec3& e = material.emission;
            if (e != vec3(0.0f)) {
                // Factors end at 1; what is brighter goes into the strength.
                const float strength = std::max({1.0f, e.r, e.g, e.b});
                target["emissiveFactor"] = array_of(e / strength);
                if (strength > 1.0f) {
                    use_extension("KHR_materials_emissive_strength");
                    target["extensions"]["KHR_materials_emissive_strength"] = {
                        {"emissiveStrength", strength}};
                }
            }
            if (material.emission_texture != Material::kNoTexture)
                target["emissiveTexture"] = {
                    {"index", material.emission_texture},
                    {"texCoord", scene_.emission_coordinates.empty() ? 0 : 1}};
            if (material.alpha_cutoff) {
                target["alphaMode"] = "MASK";
                target["alphaCutoff"] = *material.alpha_cutoff;
            }
            root_["materials"].push_back(std::move(target));
        }
    }

    void describe_pictures() {
        for (std::size_t i = 0; i < scene_.textures.size(); ++i) {
            const Texture& texture = scene_.textures[i];
            std::string_view bytes(reinterpret_cast<const char*>(texture.encoded.data()),
                                   texture.encoded.size());
            if (!texture.file.empty()) {
                pictures_.push_back(read_file(texture.file, kMaxPictureBytes));
                bytes = pictures_.back().view();
            }
            picture_bytes_.push_back(bytes);
            json target{{"source", i}};
            if (texture.wrap_u != Texture::Wrap::repeat ||
                texture.wrap_v != Texture::Wrap::repeat) {
                target["sampler"] = root_["samplers"].size();
                root_["samplers"].push_back(
                    {{"wrapS", wrap_code(texture.wrap_u)}, {"wrapT", wrap_code(texture.wrap_v)}});
            }
            root_["textures"].push_back(std::move(target));
            root_["images"].push_back({{"name", texture.name},
                                       {"mimeType", picture_type(bytes)},
                                       {"bufferView", add_view(bytes.size())}});
        }
    }

    void describe_cameras_and_lights() {
        for (const Camera& camera : scene_.cameras) {
            root_["cameras"].push_back(
                {{"name", camera.name},
                 {"type", "perspective"},
                 {"perspective", {{"yfov", camera.vertical_fov}, {"znear", 0.01}}}});
            add_node({{"name", camera.name},
                      {"camera", root_["cameras"].size() - 1},
                      {"matrix", looking(camera.eye, camera.forward, camera.up)}});
        }
        // glTF has no lamps with an area but emissive triangles, which are there already.
        std::vector<Light> punctual;
        std::ranges::copy_if(scene_.lights, std::back_inserter(punctual),
                             [](const Light& light) { return light.kind <= Light::Kind::spot; });
        if (punctual.empty()) return;
        use_extension("KHR_lights_punctual");
        json& lights = root_["extensions"]["KHR_lights_punctual"]["lights"];
        for (const Light& light : punctual) {
            const vec3& i = light.intensity;
            const float strength = std::max({i.r, i.g, i.b});
            json target{{"name", light.name},
                        {"color", array_of(strength > 0.0f ? i / strength : vec3(1.0f))},
                        {"intensity", strength}};
            switch (light.kind) {
                case Light::Kind::sun:
                    target["type"] = "directional";
                    break;
                case Light::Kind::point:
                    target["type"] = "point";
                    break;
                case Light::Kind::spot:
                    target["type"] = "spot";
                    target["spot"] = {{"innerConeAngle", light.inner_angle},
                                      {"outerConeAngle", light.outer_angle}};
                    break;
                case Light::Kind::disc:
                case Light::Kind::rectangle:
                case Light::Kind::mesh:
                    break;  // not among the punctual ones
            }
            lights.push_back(std::move(target));
            const json reference{{"light", lights.size() - 1}};
            add_node(
                {{"name", light.name},
                 {"matrix", looking(light.position, light.direction, some_up(light.direction))},
                 {"extensions", {{"KHR_lights_punctual", reference}}}});
        }
    }

    /// In the order in which the views were added.
    void write_data(OutputFile& out) const {
        for (const dvec3& p : scene_.positions) out.write_raw(vec3(p - origin_));
        for (const vec2& coordinate : scene_.texture_coordinates) out.write_raw(coordinate);
        for (const vec2& coordinate : scene_.emission_coordinates) out.write_raw(coordinate);
        for (const auto& color : scene_.colors) out.write_raw(color);
        for (std::size_t i = 0; i < scene_.triangles.size(); ++i)
            out.write_raw(scene_.triangles[order_.empty() ? i : order_[i]]);
        for (const std::string_view bytes : picture_bytes_) {
            out.write(bytes);
            out.write(std::string_view("\0\0\0", (4 - bytes.size() % 4) % 4));
        }
    }

    const Scene& scene_;
    const std::filesystem::path& file_;
    dvec3 origin_{0.0};
    std::vector<std::size_t> starts_;
    std::vector<std::uint32_t> order_;
    json root_;
    std::uint64_t size_ = 0;  // of the data so far
    std::vector<std::string> extensions_;
    std::vector<FileBytes> pictures_;
    std::vector<std::string_view> picture_bytes_;
};

}  // namespace

void formats::write_glb(const Scene& scene, const std::filesystem::path& file) {
    GlbWriter(scene, file).write();
}

}  // namespace octavo
