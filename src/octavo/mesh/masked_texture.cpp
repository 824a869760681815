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

/// None, and a warning, where it cannot be read.
std::optional<Bitmap> read_picture(Scene& scene, const std::filesystem::path& folder,
                                   std::string_view reference) {
    std::string why;
    try {
        const auto file = confined_path(folder, reference);
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
    std::string warning = "texture '" + std::string(reference) + "' " + why + ": left out";
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

}  // namespace

int add_masked_texture(Scene& scene, const std::filesystem::path& folder,
                       std::string_view color_reference, std::string_view mask_reference) {
    const std::string name =
        std::string(color_reference) + " with the alpha of " + std::string(mask_reference);
    const auto known = std::ranges::find(scene.textures, name, &Texture::name);
    if (known != scene.textures.end()) return static_cast<int>(known - scene.textures.begin());

    std::optional<Bitmap> mask = read_picture(scene, folder, mask_reference);
    if (!mask) return Material::kNoTexture;
    make_alpha(*mask);
    std::optional<Bitmap> colors;
    if (!color_reference.empty()) colors = read_picture(scene, folder, color_reference);
    if (colors)
        mask = join(*colors, *mask);
    else
        for (auto& p : mask->pixels) p = {255, 255, 255, p[3]};
    Texture texture;
    texture.name = name;
    texture.encoded = encoded(*mask);
    scene.textures.push_back(std::move(texture));
    return static_cast<int>(scene.textures.size()) - 1;
}

}  // namespace octavo
