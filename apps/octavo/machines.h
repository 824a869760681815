// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "octavo/construct/build.h"

namespace octavo {
class MpiSession;
struct MpiBuildResult;
}  // namespace octavo

namespace octavo::cli {

/// The processes that mpirun has started to build together; or just this one.
class Machines {
public:
    /// @throws Error unsupported  where mpirun has started this program and it was compiled without
    ///                            MPI: each process would then do all of the work
    Machines();
    ~Machines();
    Machines(const Machines&) = delete;
    Machines& operator=(const Machines&) = delete;

    /// Does this process speak, and write the file?
    [[nodiscard]] bool is_first() const;
    [[nodiscard]] int count() const;

    /// Does the work. Where it fails here, all processes end with its exit code.
    void run(const std::function<void()>& work);

    /// octavo::build and build_and_release, by all processes; the result is the first one's.
    [[nodiscard]] BuildResult build(const Scene& scene, const BuildOptions& options);
    [[nodiscard]] BuildResult build_and_release(Scene& scene, const BuildOptions& options);

    /// By all processes, in that build.
    [[nodiscard]] std::uint64_t sent_bytes() const { return sent_bytes_; }

private:
    BuildResult take(MpiBuildResult&& result);

    std::unique_ptr<MpiSession> mpi_;
    std::uint64_t sent_bytes_ = 0;
};

}  // namespace octavo::cli
