// SPDX-License-Identifier: MIT
#include "octavo/mesh/masked_texture.h"

#include <algorithm>
#include <optional>
#include <string>

#include "octavo/core/error.h"
#include "octavo/core/file_bytes.h"
#include "octavo/mesh/confined_path.h"
#include "octavo/mesh/png.h"
#include "octavo/mesh/tga.h"

namespace octavo {
namespace {

constexpr float kMaskCutoff = 0.5f;

/// None, and a warning, where it cannot be read.
std::optional<Bitmap> read_picture(Scene& scene, const std::filesystem::path& folder,
                                   const PictureReference& reference) {
    std::string why;
    try {
        if (!reference.encoded.empty()) return decode_bitmap(reference.encoded);
        const auto file = confined_path(folder, reference.name);
        std::error_code error;
        if (!file) {
            why = "is outside the scene's folder";
        } else if (!std::filesystem::is_regular_file(*file, error)) {
            why = "is missing";
        } else {
            const FileBytes bytes = read_file(*file, kMaxPictureBytes);
            return decode_bitmap(std::as_bytes(std::span(bytes.view())));
        }
    } catch (const Error& error) {
        why = error.what();
    }
    std::string warning = "texture '" + std::string(reference.name) + "' " + why + ": left out";
    if (std::ranges::find(scene.warnings, warning) == scene.warnings.end())
        scene.warnings.push_back(std::move(warning));
    return std::nullopt;
}

/// Turns what a mask says of each pixel into alpha.
void make_alpha(Bitmap& mask) {
    if (std::ranges::any_of(mask.pixels, [](const auto& p) { return p[3] != 255; })) return;
    for (auto& p : mask.pixels)  // the brightness of the bytes, by the weights of BT.709
        p[3] = static_cast<std::uint8_t>((p[0] * 2126 + p[1] * 7152 + p[2] * 722 + 5000) / 10000);
}

/// Texels are repeated, not blended.
Bitmap join(const Bitmap& colors, const Bitmap& alpha) {
    Bitmap joined =
        make_bitmap(std::max(colors.width, alpha.width), std::max(colors.height, alpha.height));
    auto to = joined.pixels.begin();
    for (std::int64_t y = 0; y < joined.height; ++y)
        for (std::int64_t x = 0; x < joined.width; ++x, ++to) {
            const auto texel = [&](const Bitmap& of) {
                return of.at(static_cast<int>(x * of.width / joined.width),
                             static_cast<int>(y * of.height / joined.height));
            };
            *to = texel(colors);
            (*to)[3] = texel(alpha)[3];
        }
    return joined;
}

std::vector<std::byte> encoded(const Bitmap& picture) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(picture.pixels.data());
    return encode_png({bytes, 4 * picture.pixels.size()}, picture.width, picture.height,
                      PngChannels::rgba);
}

/// @return  its index, or Material::kNoTexture where the mask cannot be read
int add_masked_texture(Scene& scene, const std::filesystem::path& folder,
                       const PictureReference& color, const PictureReference& mask) {
    const std::string name =
        std::string(color.name) + " with the alpha of " + std::string(mask.name);
    const auto known = std::ranges::find(scene.textures, name, &Texture::name);
    if (known != scene.textures.end()) return static_cast<int>(known - scene.textures.begin());

    std::optional<Bitmap> picture = read_picture(scene, folder, mask);
    if (!picture) return Material::kNoTexture;
    make_alpha(*picture);
    std::optional<Bitmap> colors;
    if (!color.name.empty()) colors = read_picture(scene, folder, color);
    if (colors)
        picture = join(*colors, *picture);
    else
        for (auto& p : picture->pixels) p = {255, 255, 255, p[3]};
    Texture texture;
    texture.name = name;
    texture.encoded = encoded(*picture);
    scene.textures.push_back(std::move(texture));
    return static_cast<int>(scene.textures.size()) - 1;
}

}  // namespace

void set_base_color_texture(Scene& scene, Material& material, const std::filesystem::path& folder,
                            const PictureReference& color, const PictureReference& mask) {
    int& texture = material.base_color_texture;
    bool cut_out = !mask.name.empty();
    if (cut_out && mask.name != color.name) {
        texture = add_masked_texture(scene, folder, color, mask);
        cut_out = texture != Material::kNoTexture;
    }
    if (texture == Material::kNoTexture) texture = add_texture(scene, folder, color);
    if (cut_out) material.alpha_cutoff = kMaskCutoff;
}

}  // namespace octavo
