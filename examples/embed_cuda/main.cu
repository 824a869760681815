// SPDX-License-Identifier: MIT
//
// A CUDA renderer with a G-buffer of its own: shadow and ambient occlusion from Octavo's effects in
// the renderer's stream, and rays from a kernel of its own against the same DAG.
#include <octavo/backend/cuda/effects.h>
#include <octavo/octavo.h>

#include <cstdio>
#include <stdexcept>
#include <vector>

namespace {

namespace s = octavo::shared;

constexpr int kPoints = 4096;

void check(cudaError_t error) {
    if (error != cudaSuccess) throw std::runtime_error(cudaGetErrorString(error));
}

/// The renderer's own kernel: how far it is to the first voxel below each point, in voxels.
__global__ void fall(s::DagView dag, const float* positions, octavo::vec3 origin,
                     float voxels_per_unit, float* distances) {
    const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
    if (i >= kPoints) return;
    const s::vec3 world(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]);
    const s::vec3 grid = (world - origin) * voxels_per_unit;
    s::GridRay ray;
    ray.cell = s::ivec3(glm::floor(grid));
    ray.frac = grid - glm::floor(grid);
    ray.dir = s::vec3(0.0f, -1.0f, 0.0f);
    ray.t_min = 0.0f;
    ray.t_max = 1e30f;
    const s::GridHit hit = s::trace_closest(dag, ray, s::stop_at_voxels());
    distances[i] = hit.face == s::kFaceNone ? -1.0f : hit.t;
}

template <typename T>
T* on_device(const std::vector<T>& values) {
    T* memory = nullptr;
    check(cudaMalloc(&memory, values.size() * sizeof(T)));
    check(cudaMemcpy(memory, values.data(), values.size() * sizeof(T), cudaMemcpyHostToDevice));
    return memory;
}

}  // namespace

int main() try {
    const octavo::BuildResult model = octavo::build(octavo::make_sample("courtyard"), {.depth = 9});
    std::vector<float> positions, normals;
    const octavo::Box box = model.grid.bounds();
    for (int i = 0; i < kPoints; ++i) {
        positions.push_back(static_cast<float>(box.low.x + box.size().x * (i % 64 + 0.5) / 64));
        positions.push_back(static_cast<float>(box.low.y + box.size().y * 0.05));
        positions.push_back(static_cast<float>(box.low.z + box.size().z * (i / 64 + 0.5) / 64));
        normals.insert(normals.end(), {0.0f, 1.0f, 0.0f});
    }

    cudaStream_t stream;  // the renderer's
    check(cudaStreamCreate(&stream));
    float* d_positions = on_device(positions);
    float* d_normals = on_device(normals);
    float* d_shadow = on_device(std::vector<float>(kPoints));
    float* d_ambient = on_device(std::vector<float>(kPoints));
    float* d_distances = on_device(std::vector<float>(kPoints));

    octavo::cuda::Effects effects(model.dag, model.grid, 0, stream);
    octavo::VisibilityOptions options;
    options.light = octavo::sun_at(0.6, 0.8);
    options.shadow_samples = 16;
    options.ao_radius = 1.0;
    effects.visibility({d_positions, d_normals, 3, 3, kPoints}, options, d_shadow, d_ambient);
    fall<<<kPoints / 128, 128, 0, stream>>>(
        effects.dag(), d_positions, octavo::vec3(model.grid.origin),
        static_cast<float>(1.0 / model.grid.voxel_size), d_distances);
    check(cudaGetLastError());

    std::vector<float> shadow(kPoints), ambient(kPoints), distances(kPoints);
    check(cudaMemcpyAsync(shadow.data(), d_shadow, kPoints * sizeof(float), cudaMemcpyDeviceToHost,
                          stream));
    check(cudaMemcpyAsync(ambient.data(), d_ambient, kPoints * sizeof(float),
                          cudaMemcpyDeviceToHost, stream));
    check(cudaMemcpyAsync(distances.data(), d_distances, kPoints * sizeof(float),
                          cudaMemcpyDeviceToHost, stream));
    check(cudaStreamSynchronize(stream));
    float sums[3] = {};
    for (int i = 0; i < kPoints; ++i) {
        sums[0] += shadow[i];
        sums[1] += ambient[i];
        sums[2] += distances[i];
    }
    std::printf("mean of the sun %.3f, of the sky %.3f, way down %.1f voxels\n", sums[0] / kPoints,
                sums[1] / kPoints, sums[2] / kPoints);
} catch (const std::exception& error) {
    std::fprintf(stderr, "embed_cuda: %s\n", error.what());
    return 1;
}
