// SPDX-License-Identifier: MIT
#include "machines.h"

#include <fmt/format.h>

#include <exception>
#include <utility>

#include "exit_code.h"
#include "octavo/core/error.h"

#if OCTAVO_HAS_MPI
#include "octavo/construct/mpi/mpi_build.h"
#else
#include <cstdlib>
namespace octavo {
class MpiSession {};
}  // namespace octavo
#endif

namespace octavo::cli {

Machines::~Machines() = default;

#if OCTAVO_HAS_MPI

Machines::Machines() {
    if (started_by_mpirun()) mpi_ = std::make_unique<MpiSession>();
}

bool Machines::is_first() const {
    return !mpi_ || mpi_->rank() == 0;
}

int Machines::count() const {
    return mpi_ ? mpi_->ranks() : 1;
}

void Machines::run(const std::function<void()>& work) {
    if (count() == 1) return work();
    try {
        work();
    } catch (const std::exception& error) {
        fmt::print(stderr, "octavo: rank {}: {}\n", mpi_->rank(), error.what());
        mpi_->abort(exit_code(error));
    }
}

BuildResult Machines::build_and_release(Scene& scene, const BuildOptions& options) {
    if (count() == 1) return octavo::build_and_release(scene, options);
    return take(build_with_mpi_and_release(*mpi_, scene, options));
}

BuildResult Machines::build(const Scene& scene, const BuildOptions& options) {
    if (count() == 1) return octavo::build(scene, options);
    return take(build_with_mpi(*mpi_, scene, options));
}

BuildResult Machines::take(MpiBuildResult&& result) {
    sent_bytes_ = result.sent_bytes;
    return std::move(result.built);
}

#else

Machines::Machines() {
    const char* ranks = std::getenv("OMPI_COMM_WORLD_SIZE");
    if (ranks != nullptr && std::atoi(ranks) > 1)
        throw Error(Errc::unsupported, "this octavo was compiled without MPI (libopenmpi-dev)");
}

bool Machines::is_first() const {
    return true;
}

int Machines::count() const {
    return 1;
}

void Machines::run(const std::function<void()>& work) {
    work();
}

BuildResult Machines::build(const Scene& scene, const BuildOptions& options) {
    return octavo::build(scene, options);
}

BuildResult Machines::build_and_release(Scene& scene, const BuildOptions& options) {
    return octavo::build_and_release(scene, options);
}

#endif

}  // namespace octavo::cli
