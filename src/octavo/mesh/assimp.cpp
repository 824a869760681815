// SPDX-License-Identifier: MIT
//
// Every format that we do not read ourselves, through assimp. Its coordinates are floats.
#include <assimp/DefaultIOSystem.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <cmath>
#include <vector>

#include "octavo/core/file_name.h"
#include "octavo/mesh/color.h"
#include "octavo/mesh/confined_path.h"
#include "octavo/mesh/formats.h"
#include "octavo/mesh/masked_texture.h"

namespace octavo {
namespace {

/// Keeps assimp, too, from reading outside the scene's folder.
class ConfinedFiles : public Assimp::DefaultIOSystem {
public:
    explicit ConfinedFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

    bool Exists(const char* file) const override {
        return is_inside(folder_, file) && Assimp::DefaultIOSystem::Exists(file);
    }
    Assimp::IOStream* Open(const char* file, const char* mode) override {
        std::error_code ignored;  // a pipe would keep it waiting
        return is_inside(folder_, file) && std::filesystem::is_regular_file(file, ignored)
                   ? Assimp::DefaultIOSystem::Open(file, mode)
                   : nullptr;
    }

private:
    std::filesystem::path folder_;
};

dmat4 matrix_of(const aiMatrix4x4& m) {  // assimp's rows are our columns
    return {dvec4(m.a1, m.b1, m.c1, m.d1), dvec4(m.a2, m.b2, m.c2, m.d2),
            dvec4(m.a3, m.b3, m.c3, m.d3), dvec4(m.a4, m.b4, m.c4, m.d4)};
}

dvec3 vector_of(const aiVector3D& v) {
    return {v.x, v.y, v.z};
}
vec3 color_of(const aiColor3D& c) {
    return {c.r, c.g, c.b};
}

dvec3 unit(const dmat4& world, const aiVector3D& direction, const dvec3& fallback) {
    const dvec3 moved(world * dvec4(vector_of(direction), 0.0));
    const double length = glm::length(moved);
    return length > 0.0 ? moved / length : fallback;
}

/// What every file of a format means and assimp's scene does not say.
struct Customs {
    bool z_is_up = false;
    bool texture_alpha_is_holes = false;
};
Customs customs_of(const std::filesystem::path& file) {
    const std::string extension = lowercase_extension(file);
    if (extension == ".blend") return {.z_is_up = true};
    if (extension == ".ac" || extension == ".acc") return {.texture_alpha_is_holes = true};
    return {};
}

const dmat4 kZUpToYUp{dvec4(1, 0, 0, 0), dvec4(0, 0, -1, 0), dvec4(0, 1, 0, 0), dvec4(0, 0, 0, 1)};

class AssimpScene {
public:
    AssimpScene(const aiScene& source, const std::filesystem::path& file)
        : source_(source), file_(file), customs_(customs_of(file)) {}

    Scene convert() {
        for (unsigned i = 0; i < source_.mNumMaterials; ++i) add_material(*source_.mMaterials[i]);
        struct Visit {
            const aiNode* node;
            dmat4 parent;
        };
        std::vector<Visit> open{{source_.mRootNode, customs_.z_is_up ? kZUpToYUp : dmat4(1.0)}};
        while (!open.empty()) {
            const auto [node, parent] = open.back();
            open.pop_back();
            if (!node) continue;
            const dmat4 world = parent * matrix_of(node->mTransformation);
            for (unsigned i = 0; i < node->mNumMeshes; ++i)
                add_mesh(*source_.mMeshes[node->mMeshes[i]], world);
            add_lights(node->mName, world);
            add_cameras(node->mName, world);
            for (unsigned i = node->mNumChildren; i-- > 0;)
                open.push_back({node->mChildren[i], world});
        }
        return std::move(scene_);
    }

private:
    /// @param name  keeps the characters that the reference views
    PictureReference picture_of(const aiMaterial& material, aiTextureType type, aiString& name) {
        if (material.GetTexture(type, 0, &name) != aiReturn_SUCCESS) return {};
        const aiTexture* embedded = source_.GetEmbeddedTexture(name.C_Str());
        if (!embedded) return {name.C_Str()};
        if (embedded->mHeight != 0) {
            scene_.warnings.push_back("an unencoded embedded texture was left out");
            return {};
        }
        const auto* first = reinterpret_cast<const std::byte*>(embedded->pcData);
        return {name.C_Str(), {first, embedded->mWidth}};
    }

    void add_textures(const aiMaterial& source, Material& material) {
        aiString color_name, mask_name, emission_name;
        PictureReference color = picture_of(source, aiTextureType_DIFFUSE, color_name);
        if (color.name.empty()) color = picture_of(source, aiTextureType_BASE_COLOR, color_name);
        PictureReference mask = picture_of(source, aiTextureType_OPACITY, mask_name);
        int flags = 0;
        source.Get(AI_MATKEY_TEXFLAGS_DIFFUSE(0), flags);
        if (mask.name.empty() &&
            (customs_.texture_alpha_is_holes || (flags & aiTextureFlags_UseAlpha) != 0))
            mask = color;
        const std::filesystem::path folder = folder_of(file_);
        set_base_color_texture(scene_, material, folder, color, mask);
        // The factor is often 0 in files whose map says how much.
        if (material.alpha_cutoff) material.base_color.a = 1.0f;
        material.emission_texture =
            add_texture(scene_, folder, picture_of(source, aiTextureType_EMISSIVE, emission_name));
    }

    void add_material(const aiMaterial& source) {
        Material material;
        material.name = source.GetName().C_Str();
        aiColor4D color(1.0f, 1.0f, 1.0f, 1.0f);
        if (source.Get(AI_MATKEY_BASE_COLOR, color) != aiReturn_SUCCESS)
            source.Get(AI_MATKEY_COLOR_DIFFUSE, color);
        float opacity = color.a;
        source.Get(AI_MATKEY_OPACITY, opacity);
        material.base_color = {color.r, color.g, color.b, opacity};
        aiColor3D emission(0.0f, 0.0f, 0.0f);
        source.Get(AI_MATKEY_COLOR_EMISSIVE, emission);
        material.emission = color_of(emission);
        add_textures(source, material);
        scene_.materials.push_back(std::move(material));
    }

    void add_mesh(const aiMesh& mesh, const dmat4& world) {
        const std::size_t base = scene_.positions.size();
        if (mesh.mNumVertices > Scene::kNoMaterial - base)
            throw Error(Errc::limit, file_, "has more than 2^32 vertices");
        for (unsigned i = 0; i < mesh.mNumVertices; ++i)
            scene_.positions.emplace_back(world * dvec4(vector_of(mesh.mVertices[i]), 1.0));
        const std::size_t size = scene_.positions.size();

        if (mesh.HasTextureCoords(0)) {
            scene_.texture_coordinates.resize(base);
            for (unsigned i = 0; i < mesh.mNumVertices; ++i)
                scene_.texture_coordinates.emplace_back(mesh.mTextureCoords[0][i].x,
                                                        mesh.mTextureCoords[0][i].y);
        } else if (!scene_.texture_coordinates.empty()) {
            scene_.texture_coordinates.resize(size);
        }
        if (mesh.HasVertexColors(0)) {
            scene_.colors.resize(base, kWhite);
            for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
                const aiColor4D& c = mesh.mColors[0][i];
                scene_.colors.push_back(
                    {unit_to_byte(c.r), unit_to_byte(c.g), unit_to_byte(c.b), unit_to_byte(c.a)});
            }
        } else if (!scene_.colors.empty()) {
            scene_.colors.resize(size, kWhite);
        }

        for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
            const aiFace& face = mesh.mFaces[i];
            if (face.mNumIndices != 3) continue;  // points and lines
            uvec3 triangle;
            for (int c = 0; c < 3; ++c) {
                if (face.mIndices[c] >= mesh.mNumVertices)
                    throw Error(Errc::bad_input, file_, "a face refers to a missing vertex");
                triangle[c] = static_cast<std::uint32_t>(base + face.mIndices[c]);
            }
            scene_.triangles.push_back(triangle);
        }
        scene_.triangle_materials.resize(scene_.triangles.size(), mesh.mMaterialIndex);
    }

    /// Those of the node of this name.
    void add_lights(const aiString& name, const dmat4& world) {
        for (unsigned i = 0; i < source_.mNumLights; ++i) {
            const aiLight& source = *source_.mLights[i];
            if (source.mName != name) continue;
            Light light;
            light.name = name.C_Str();
            switch (source.mType) {
                case aiLightSource_DIRECTIONAL:
                    light.kind = Light::Kind::sun;
                    break;
                case aiLightSource_POINT:
                    light.kind = Light::Kind::point;
                    break;
                case aiLightSource_SPOT:
                    light.kind = Light::Kind::spot;
                    break;
                default:
                    scene_.warnings.push_back("a light of unknown kind was passed over");
                    continue;
            }
            light.position = dvec3(world * dvec4(vector_of(source.mPosition), 1.0));
            light.direction = unit(world, source.mDirection, light.direction);
            light.intensity = color_of(source.mColorDiffuse);
            light.inner_angle = 0.5 * source.mAngleInnerCone;
            light.outer_angle = 0.5 * source.mAngleOuterCone;
            scene_.lights.push_back(std::move(light));
        }
    }

    void add_cameras(const aiString& name, const dmat4& world) {
        for (unsigned i = 0; i < source_.mNumCameras; ++i) {
            const aiCamera& source = *source_.mCameras[i];
            if (source.mName != name) continue;
            Camera camera;
            camera.name = name.C_Str();
            camera.eye = dvec3(world * dvec4(vector_of(source.mPosition), 1.0));
            camera.forward = unit(world, source.mLookAt, camera.forward);
            const dvec3 up = unit(world, source.mUp, camera.up);
            const dvec3 right = glm::cross(camera.forward, up);
            if (glm::length(right) > 1e-6)
                camera.up = glm::normalize(glm::cross(right, camera.forward));
            constexpr double kUsualAspect = 4.0 / 3.0;
            const double aspect = source.mAspect > 0.0f ? source.mAspect : kUsualAspect;
            camera.vertical_fov = 2.0 * std::atan(std::tan(0.5 * source.mHorizontalFOV) / aspect);
            scene_.cameras.push_back(std::move(camera));
        }
    }

    const aiScene& source_;
    const std::filesystem::path& file_;
    const Customs customs_;
    Scene scene_;
};

}  // namespace

bool formats::assimp_knows(const std::filesystem::path& file) {
    // The 3MF reader of assimp 5.2 frees memory twice on ordinary files.
    if (lowercase_extension(file) == ".3mf") return false;
    const Assimp::Importer importer;
    return importer.IsExtensionSupported(file.extension().string());
}

Scene formats::read_with_assimp(const std::filesystem::path& file) {
    Assimp::Importer importer;
    importer.SetIOHandler(new ConfinedFiles(folder_of(file)));  // the importer deletes it
    const aiScene* source =
        importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_FlipUVs);
    if (!source) throw Error(Errc::bad_input, file, importer.GetErrorString());
    return AssimpScene(*source, file).convert();
}

}  // namespace octavo
