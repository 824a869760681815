// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mesh/mesh_files.h"

namespace octavo::test {

using nlohmann::json;

/// Puts a glTF file together: data.bin beside it, one bufferView per accessor.
struct GltfFile {
    json root{{"asset", {{"version", "2.0"}}}};
    std::string data;

    template <class T>
    int accessor(const std::vector<T>& values, int component, const char* type, int components,
                 bool normalized = false) {
        while (data.size() % 4 != 0) data += '\0';
        json view{
            {"buffer", 0}, {"byteOffset", data.size()}, {"byteLength", values.size() * sizeof(T)}};
        for (const T& value : values) data += raw(value);
        root["bufferViews"].push_back(view);
        root["accessors"].push_back(
            {{"bufferView", root["bufferViews"].size() - 1},
             {"componentType", component},
             {"count", values.size() / static_cast<std::size_t>(components)},
             {"type", type},
             {"normalized", normalized}});
        return static_cast<int>(root["accessors"].size()) - 1;
    }
    int positions(const std::vector<float>& values) { return accessor(values, 5126, "VEC3", 3); }

    std::filesystem::path write(const TemporaryFolder& folder) {
        folder.write("my data.bin", data);
        if (!data.empty())
            root["buffers"] = {{{"uri", "my%20data.bin"}, {"byteLength", data.size()}}};
        return folder.write("a.gltf", root.dump());
    }
};

}  // namespace octavo::test
