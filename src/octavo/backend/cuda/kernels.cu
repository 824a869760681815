// SPDX-License-Identifier: MIT
#include "octavo/backend/cuda/kernels.h"
#include "octavo/backend/pass_queue.h"

namespace octavo::cuda {
namespace {

/// Two 8x8 tiles: enough warps for the scheduler, few enough that a slow tile holds up little.
constexpr unsigned kBlockThreads = 128;

using shared::PixelJob;
using shared::RayJob;
static_assert(sizeof(PixelJob) <= 4096, "an argument of a kernel");

// A kernel for each pass: a job is its argument, which lies in constant memory.
#define OCTAVO_KERNEL(pass, Job)                                                \
    __global__ void __launch_bounds__(kBlockThreads)                            \
        pass##_kernel(const __grid_constant__ Job job, std::uint32_t threads) { \
        const std::uint32_t i = blockIdx.x * kBlockThreads + threadIdx.x;       \
        if (i < threads) shared::pass##_pass(job, i);                           \
    }
OCTAVO_KERNEL(closest, RayJob)
OCTAVO_KERNEL(any, RayJob)
OCTAVO_KERNEL(beam, PixelJob)
OCTAVO_KERNEL(primary, PixelJob)
OCTAVO_KERNEL(surface, PixelJob)
OCTAVO_KERNEL(gbuffer, PixelJob)
OCTAVO_KERNEL(sky, PixelJob)
OCTAVO_KERNEL(lamp_beam, PixelJob)
OCTAVO_KERNEL(lamp, PixelJob)
OCTAVO_KERNEL(light, PixelJob)
OCTAVO_KERNEL(shade, PixelJob)
OCTAVO_KERNEL(ambient_out, PixelJob)
OCTAVO_KERNEL(shadow_out, PixelJob)
OCTAVO_KERNEL(looks, PixelJob)
OCTAVO_KERNEL(cached, PixelJob)
OCTAVO_KERNEL(gbuffer_looks, PixelJob)
#undef OCTAVO_KERNEL

template <typename Job>
int start(void (*kernel)(Job, std::uint32_t), const Job& job, std::uint32_t threads,
          cudaStream_t stream) {
    const unsigned blocks = (threads + kBlockThreads - 1) / kBlockThreads;
    kernel<<<blocks, kBlockThreads, 0, stream>>>(job, threads);
    return static_cast<int>(cudaGetLastError());
}

}  // namespace

int launch(Pass pass, const RayJob& job, std::uint32_t threads, CUstream_st* stream) {
    return pass == Pass::closest ? start(closest_kernel, job, threads, stream)
                                 : start(any_kernel, job, threads, stream);
}

int launch(Pass pass, const PixelJob& job, std::uint32_t threads, CUstream_st* stream) {
    switch (pass) {
        case Pass::beam:
            return start(beam_kernel, job, threads, stream);
        case Pass::primary:
            return start(primary_kernel, job, threads, stream);
        case Pass::surface:
            return start(surface_kernel, job, threads, stream);
        case Pass::gbuffer:
            return start(gbuffer_kernel, job, threads, stream);
        case Pass::sky:
            return start(sky_kernel, job, threads, stream);
        case Pass::lamp_beam:
            return start(lamp_beam_kernel, job, threads, stream);
        case Pass::lamp:
            return start(lamp_kernel, job, threads, stream);
        case Pass::light:
            return start(light_kernel, job, threads, stream);
        case Pass::shade:
            return start(shade_kernel, job, threads, stream);
        case Pass::ambient_out:
            return start(ambient_out_kernel, job, threads, stream);
        case Pass::shadow_out:
            return start(shadow_out_kernel, job, threads, stream);
        case Pass::looks:
            return start(looks_kernel, job, threads, stream);
        case Pass::cached:
            return start(cached_kernel, job, threads, stream);
        case Pass::gbuffer_looks:
            return start(gbuffer_looks_kernel, job, threads, stream);
        default:
            return static_cast<int>(cudaErrorInvalidValue);
    }
}

}  // namespace octavo::cuda
