// SPDX-License-Identifier: MIT
#include "octavo/mesh/scene_archive.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <type_traits>

#include "octavo/core/error.h"

namespace octavo {
namespace {

class Writer {
public:
    explicit Writer(int descriptor) : descriptor_(descriptor) {}

    void bytes(const void* from, std::size_t size) {
        const auto* next = static_cast<const std::byte*>(from);
        while (size > 0) {
            const ssize_t count = write(descriptor_, next, size);
            if (count < 0 && errno == EINTR) continue;
            if (count < 0) throw io_error("a scene from another process", "write");
            next += count;
            size -= static_cast<std::size_t>(count);
        }
    }
    std::size_t count(std::size_t size, std::size_t /*least_bytes*/) {
        const std::uint64_t written = size;
        bytes(&written, sizeof written);
        return size;
    }

private:
    int descriptor_;
};

class Reader {
public:
    explicit Reader(std::span<const std::byte> rest) : rest_(rest) {}

    void bytes(void* to, std::size_t size) {
        if (size > rest_.size()) refuse();
        if (size > 0) std::memcpy(to, rest_.data(), size);
        rest_ = rest_.subspan(size);
    }
    std::size_t count(std::size_t /*size*/, std::size_t least_bytes) {
        std::uint64_t read = 0;
        bytes(&read, sizeof read);
        if (read > rest_.size() / least_bytes) refuse();
        return static_cast<std::size_t>(read);
    }
    [[noreturn]] static void refuse() {
        throw Error(Errc::bad_input, "the reader of this format has failed");
    }
    [[nodiscard]] bool done() const { return rest_.empty(); }

private:
    std::span<const std::byte> rest_;
};

// One list of fields for both ways, so that they cannot differ.

template <class Archive, class T>
requires std::is_trivially_copyable_v<T>
void each(Archive& archive, T& value) {
    archive.bytes(&value, sizeof value);
}

template <class Archive>
void each(Archive& archive, std::string& text) {
    text.resize(archive.count(text.size(), 1));
    archive.bytes(text.data(), text.size());
}

template <class Archive>
void each(Archive& archive, std::filesystem::path& path) {
    std::string text = path.string();
    each(archive, text);
    path = text;
}

template <class Archive, class T>
requires std::is_trivially_copyable_v<T>
void each(Archive& archive, std::vector<T>& values) {
    values.resize(archive.count(values.size(), sizeof(T)));
    archive.bytes(values.data(), values.size() * sizeof(T));
}

template <class Archive, class First, class... Rest>
requires(sizeof...(Rest) > 0) void each(Archive& archive, First& first, Rest&... rest) {
    each(archive, first);
    (each(archive, rest), ...);
}

template <class Archive, class Enum>
void each_enum(Archive& archive, Enum& value, Enum last) {
    auto number = static_cast<std::uint8_t>(value);
    each(archive, number);
    if (number > static_cast<std::uint8_t>(last)) Reader::refuse();
    value = static_cast<Enum>(number);
}

template <class Archive>
void each(Archive& archive, Texture& texture) {
    each(archive, texture.name, texture.file, texture.encoded);
    each_enum(archive, texture.wrap_u, Texture::Wrap::mirror);
    each_enum(archive, texture.wrap_v, Texture::Wrap::mirror);
}

template <class Archive>
void each(Archive& archive, Material& material) {
    each(archive, material.name, material.base_color, material.base_color_texture,
         material.emission, material.emission_texture);
    float cutoff = material.alpha_cutoff.value_or(-1.0f);
    each(archive, cutoff);
    material.alpha_cutoff = cutoff >= 0.0f ? std::optional(cutoff) : std::nullopt;
}

template <class Archive>
void each(Archive& archive, Camera& camera) {
    each(archive, camera.name, camera.eye, camera.forward, camera.up, camera.vertical_fov);
}

template <class Archive>
void each(Archive& archive, Light& light) {
    each(archive, light.name);
    each_enum(archive, light.kind, Light::Kind::mesh);
    each(archive, light.position, light.direction, light.intensity, light.inner_angle,
         light.outer_angle, light.size, light.half_u, light.half_v, light.triangles);
}

template <class Archive, class T>
requires(!std::is_trivially_copyable_v<T>) void each(Archive& archive, std::vector<T>& values) {
    values.resize(archive.count(values.size(), 1));
    for (T& value : values) each(archive, value);
}

template <class Archive>
void each(Archive& archive, Scene& scene) {
    each(archive, scene.positions, scene.triangles, scene.texture_coordinates,
         scene.emission_coordinates, scene.colors, scene.triangle_materials, scene.materials,
         scene.textures, scene.cameras, scene.lights, scene.warnings);
}

}  // namespace

void write_scene(int descriptor, Scene& scene) {
    Writer writer(descriptor);
    each(writer, scene);
}

Scene read_scene_bytes(std::span<const std::byte> bytes) {
    Reader reader(bytes);
    Scene scene;
    each(reader, scene);
    if (!reader.done()) Reader::refuse();
    return scene;
}

}  // namespace octavo
