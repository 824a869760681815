// SPDX-License-Identifier: MIT
#include "octavo/mesh/gltf_materials.h"

#include <cmath>
#include <map>

#include "octavo/mesh/confined_path.h"
#include "octavo/mesh/texture_files.h"

namespace octavo::gltf {
namespace {

constexpr float kDefaultCutoff = 0.5f;

/// The wrap modes of OpenGL; others count as the usual one.
Texture::Wrap wrap_of(std::size_t code) {
    constexpr std::size_t kClampToEdge = 33071, kMirroredRepeat = 33648;
    if (code == kClampToEdge) return Texture::Wrap::clamp;
    return code == kMirroredRepeat ? Texture::Wrap::mirror : Texture::Wrap::repeat;
}

class MaterialReader {
public:
    MaterialReader(Document& document, Scene& scene) : document_(document), scene_(scene) {}

    MaterialPlacement read(const json& source) {
        Material material;
        MaterialPlacement placement;
        material.name = value_or<std::string>(source, "name", "");

        if (const json* pbr = child(source, "pbrMetallicRoughness")) {
            material.base_color = vec4(numbers(*pbr, "baseColorFactor", dvec4(1.0)));
            material.base_color_texture = texture(child(*pbr, "baseColorTexture"), placement.base);
        } else if (const json* old = extension(source, "KHR_materials_pbrSpecularGlossiness")) {
            material.base_color = vec4(numbers(*old, "diffuseFactor", dvec4(1.0)));
            material.base_color_texture = texture(child(*old, "diffuseTexture"), placement.base);
        }

        material.emission = vec3(numbers(source, "emissiveFactor", dvec4(0.0)));
        if (const json* strength = extension(source, "KHR_materials_emissive_strength"))
            material.emission *= value_or(*strength, "emissiveStrength", 1.0f);
        material.emission_texture = texture(child(source, "emissiveTexture"), placement.emission);
        if (material.emission_texture == Material::kNoTexture)
            placement.emission = placement.base;
        else if (material.base_color_texture == Material::kNoTexture)
            placement.base = placement.emission;

        const auto mode = value_or<std::string>(source, "alphaMode", "OPAQUE");
        if (mode == "MASK") material.alpha_cutoff = value_or(source, "alphaCutoff", kDefaultCutoff);
        if (mode == "BLEND")
            scene_.warnings.push_back("material '" + material.name +
                                      "' is transparent: taken as opaque");
        scene_.materials.push_back(std::move(material));
        return placement;
    }

private:
    /// The scene's texture for a textureInfo object.
    int texture(const json* info, TexturePlacement& placement) {
        if (!info) return Material::kNoTexture;
        placement.set = whole(*info, "texCoord").value_or(0);
        if (const json* moved = extension(*info, "KHR_texture_transform")) {
            placement.offset = glm::dvec2(numbers(*moved, "offset", dvec4(0.0)));
            placement.scale = glm::dvec2(numbers(*moved, "scale", dvec4(1.0)));
            placement.rotation = value_or(*moved, "rotation", 0.0);
            placement.set = whole(*moved, "texCoord").value_or(placement.set);
        }
        const auto index = whole(*info, "index");
        if (!index) return Material::kNoTexture;
        const json& texture = document_.object("textures", *index);
        const auto source = whole(texture, "source");
        if (!source) {
            scene_.warnings.push_back("texture " + std::to_string(*index) +
                                      " has no picture in a known format: left out");
            return Material::kNoTexture;
        }
        Placed placed{*source, Texture::Wrap::repeat, Texture::Wrap::repeat};
        if (const auto sampler = whole(texture, "sampler")) {
            const json& modes = document_.object("samplers", *sampler);
            placed.wrap_u = wrap_of(whole(modes, "wrapS").value_or(0));
            placed.wrap_v = wrap_of(whole(modes, "wrapT").value_or(0));
        }
        const auto known = images_.find(placed);
        if (known != images_.end()) return known->second;
        return images_[placed] = image(document_.object("images", *source), placed);
    }

    /// A picture, and how it goes on beyond its edges.
    struct Placed {
        std::size_t image;
        Texture::Wrap wrap_u, wrap_v;
        // NOLINTNEXTLINE(modernize-use-nullptr): the linter takes the 0 of <=> for a pointer
        friend auto operator<=>(const Placed&, const Placed&) = default;
    };

    int image(const json& source, const Placed& placed) {
        Texture texture;
        texture.wrap_u = placed.wrap_u;
        texture.wrap_v = placed.wrap_v;
        texture.name = value_or<std::string>(source, "name", "");
        if (const auto view = whole(source, "bufferView")) {
            const auto bytes = document_.buffer_view(*view);
            texture.encoded.assign(bytes.begin(), bytes.end());
        } else {
            const auto uri = value_or<std::string>(source, "uri", "");
            auto data = data_uri(uri);
            if (!data)
                return add_texture_file(scene_, folder_of(document_.file().file()),
                                        percent_decoded(uri), placed.wrap_u, placed.wrap_v);
            texture.encoded = std::move(*data);
        }
        scene_.textures.push_back(std::move(texture));
        return static_cast<int>(scene_.textures.size()) - 1;
    }

    Document& document_;
    Scene& scene_;
    std::map<Placed, int> images_;
};

}  // namespace

vec2 TexturePlacement::apply(const glm::dvec2& coordinate) const {
    const double c = std::cos(rotation), s = std::sin(rotation);
    const glm::dvec2 p = coordinate * scale;
    return vec2(glm::dvec2(c * p.x + s * p.y, c * p.y - s * p.x) + offset);
}

std::vector<MaterialPlacement> read_materials(Document& document, Scene& scene) {
    MaterialReader reader(document, scene);
    std::vector<MaterialPlacement> placements;
    for (std::size_t i = 0; i < document.count("materials"); ++i)
        placements.push_back(reader.read(document.object("materials", i)));
    return placements;
}

}  // namespace octavo::gltf
