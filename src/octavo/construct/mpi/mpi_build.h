// SPDX-License-Identifier: MIT
#pragma once

#include "octavo/construct/build.h"
#include "octavo/construct/mpi/mpi_session.h"

namespace octavo {

struct MpiBuildResult {
    BuildResult built;             // at rank 0; elsewhere without a DAG
    std::uint64_t sent_bytes = 0;  // by all ranks
};

/// build() by all ranks of an mpirun together; each calls this with the same scene and options, and
/// rank 0 gets the result: the same words as from one process.
///
/// Rank 0 hands out runs of tiles as ranks become free. A rank makes parts of them (see PartFile)
/// in its scratch folder. Then each rank receives the parts of one stretch of the tiles, merges
/// them in order, and neighbours merge pairwise until rank 0 has all;
/// docs/adr/0009-many-machines.md.
///
/// @param options  scratch is not empty; where ranks see the same folder, a job that has died goes
///                 on from it with any number of ranks. max_memory_bytes is for each rank
/// @throws Error   as build(), at the rank where it happens, which should then call abort()
[[nodiscard]] MpiBuildResult build_with_mpi(MpiSession& mpi, const Scene& scene,
                                            const BuildOptions& options);

/// The same for a scene that is not needed any more, as build_and_release().
[[nodiscard]] MpiBuildResult build_with_mpi_and_release(MpiSession& mpi, Scene& scene,
                                                        const BuildOptions& options);

}  // namespace octavo
