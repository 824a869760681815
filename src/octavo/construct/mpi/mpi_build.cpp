// SPDX-License-Identifier: MIT
// Source: [K13] section 3: subtrees are reduced on their own and merged; here by different
// machines.
#include "octavo/construct/mpi/mpi_build.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <mutex>
#include <numeric>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "octavo/construct/build_plan.h"
#include "octavo/construct/frozen_part.h"
#include "octavo/construct/merge_parts.h"
#include "octavo/construct/part_builder.h"
#include "octavo/core/parallel.h"

namespace octavo {
namespace {

enum Tag : int { kRequest = 1, kWork, kPartSize, kPartBytes };

// Runs of tiles for each rank: enough that none waits long for the last, few enough that what runs
// have in common is not written and sent too often.
constexpr std::uint64_t kRunsPerRank = 16;

struct TileRange {
    std::uint64_t begin = 0, end = 0;
    [[nodiscard]] bool empty() const { return begin == end; }
};

/// What a rank says when it asks for work: what it has done since it last asked.
struct Done {
    std::uint64_t tiles = 0, voxels = 0;
};

/// Rank 0's list of what is to be done. The other ranks ask by message, which a thread of its own
/// answers; rank 0 asks directly.
class WorkList {
public:
    WorkList(MpiSession& mpi, std::vector<TileRange> ranges, Done so_far)
        : mpi_(mpi), ranges_(std::move(ranges)), done_(so_far) {
        if (mpi_.ranks() == 1) return;
        answering_ = std::jthread([this](const std::stop_token& stop) { answer(stop); });
    }

    TileRange next(const Done& done) {
        const std::scoped_lock lock(mutex_);
        done_.tiles += done.tiles;
        done_.voxels += done.voxels;
        return next_ < ranges_.size() ? ranges_[next_++] : TileRange();
    }

    [[nodiscard]] Done done() {
        const std::scoped_lock lock(mutex_);
        return done_;
    }

private:
    /// Until every other rank has been told that there is no more.
    void answer(const std::stop_token& stop) {
        int working = mpi_.ranks() - 1;
        while (working > 0 && !stop.stop_requested()) {
            int from = 0;
            if (!mpi_.probe(kRequest, from)) {
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
                continue;
            }
            Done done;
            mpi_.receive(from, kRequest, &done, sizeof done, MpiSession::Waiting::silent);
            const TileRange range = next(done);
            mpi_.send(from, kWork, &range, sizeof range, MpiSession::Waiting::silent);
            working -= range.empty();
        }
    }

    MpiSession& mpi_;
    std::mutex mutex_;
    std::vector<TileRange> ranges_;
    std::size_t next_ = 0;
    Done done_;
    std::jthread answering_;
};

/// Cuts the tiles that no part has into runs.
std::vector<TileRange> cut_into_runs(std::uint64_t tiles, const std::vector<TileRange>& done,
                                     int ranks) {
    std::uint64_t left = tiles;
    for (const TileRange& range : done) left -= range.end - range.begin;
    const std::uint64_t size =
        std::max<std::uint64_t>(1, left / (kRunsPerRank * static_cast<std::uint64_t>(ranks)));
    std::vector<TileRange> runs;
    std::uint64_t next = 0;
    const auto fill_to = [&](std::uint64_t end) {
        for (; next < end; next = runs.back().end)
            runs.push_back({next, std::min(end, next + size)});
    };
    for (const TileRange& range : done) {
        fill_to(range.begin);
        next = range.end;
    }
    fill_to(tiles);
    return runs;
}

/// A part, and the rank that has it.
struct Located {
    TileRange tiles;
    std::uint64_t bytes = 0;
    int rank = 0;
};

/// What all ranks have, in the order of tiles; where several see the same folder, the first counts.
std::vector<Located> locate(MpiSession& mpi, const std::vector<std::unique_ptr<PartFile>>& mine) {
    std::vector<std::uint64_t> numbers;
    for (const auto& part : mine)
        for (const std::uint64_t n :
             {part->state().first_tile, part->state().end_tile, part->file_bytes()})
            numbers.push_back(n);
    const auto lists = mpi.gather_everywhere(numbers);
    std::vector<Located> parts;
    for (std::size_t r = 0; r < lists.size(); ++r)
        for (std::size_t i = 0; i + 2 < lists[r].size(); i += 3)
            parts.push_back({{lists[r][i], lists[r][i + 1]}, lists[r][i + 2], static_cast<int>(r)});
    std::ranges::stable_sort(parts, {}, [](const Located& part) { return part.tiles.begin; });
    std::uint64_t end = 0;
    std::erase_if(parts, [&](const Located& part) {
        const bool overlaps = part.tiles.begin < end;
        if (!overlaps) end = part.tiles.end;
        return overlaps;
    });
    return parts;
}

/// One rank's share of the build.
class RankBuild {
public:
    RankBuild(MpiSession& mpi, const VoxelSource& source, int depth, const BuildOptions& options,
              Scratch& scratch)
        : mpi_(mpi),
          source_(source),
          depth_(depth),
          options_(options),
          limits_{options.max_memory_bytes, options.spill.node_bytes},
          scratch_(scratch) {}

    /// At rank 0 all of the scene; elsewhere nothing.
    Constructed run() {
        find_what_is_done();
        build_runs();
        std::unique_ptr<PartFile> merged = merge_own(collect_stretch());
        merged = merge_pairwise(std::move(merged));
        if (mpi_.rank() != 0) return {};
        if (!merged) return empty();
        return freeze_part(*merged, depth_, scratch_.folder(), options_.progress);
    }

private:
    void find_what_is_done() {
        // Rank 0 takes the folder first, so that the others see what it leaves.
        if (mpi_.rank() == 0) {
            scratch_.open();
            parts_ = scratch_.take_parts();
        }
        barrier();
        if (mpi_.rank() != 0) {
            scratch_.open();
            parts_ = find_parts(scratch_.folder(), scratch_.key(), scratch_.top()).parts;
        }
        const std::vector<Located> located = locate(mpi_, parts_);
        std::vector<TileRange> done;
        for (const Located& part : located) done.push_back(part.tiles);
        runs_ = cut_into_runs(source_.tiles().size(), done, mpi_.ranks());
        std::erase_if(parts_, [&](const auto& part) {
            return std::ranges::none_of(located, [&](const Located& l) {
                return l.rank == mpi_.rank() && l.tiles.begin == part->state().first_tile;
            });
        });
        for (const TileRange& range : done) done_.tiles += range.end - range.begin;
        for (const auto& part : parts_) done_.voxels += part->state().counts.voxels;
        // Only rank 0 shows progress, so it must know what the others bring along.
        std::uint64_t voxels = 0;
        for (const auto& other : mpi_.gather_everywhere({done_.voxels})) voxels += other[0];
        done_.voxels = voxels;
    }

    void build_runs() {
        std::unique_ptr<WorkList> list;
        if (mpi_.rank() == 0) {
            list = std::make_unique<WorkList>(mpi_, runs_, done_);
            mpi_.while_waiting = [&] { show("voxelize", list->done()); };
        }
        PartBuilder builder(source_, depth_, scratch_, limits_, std::chrono::hours(24 * 365));
        Done done;
        for (;;) {
            const TileRange run = list ? list->next(done) : ask_for_work(done);
            if (run.empty()) break;
            const std::uint64_t voxels = builder.voxels();
            std::vector<std::size_t> tiles(run.end - run.begin);
            std::iota(tiles.begin(), tiles.end(), run.begin);
            const bool frugal = limits_.max_resident_bytes != 0;
            run_tiles(source_, tiles, frugal, options_.reduce, [&](const TilePart& tile) {
                builder.merge(tile);
                if (list) {
                    Done now = list->done();
                    now.voxels += builder.voxels() - voxels;
                    now.tiles += tile.index + 1 - run.begin;
                    show("voxelize", now);
                }
            });
            builder.close();
            done = {run.end - run.begin, builder.voxels() - voxels};
        }
        for (auto& part : builder.take_closed()) parts_.push_back(std::move(part));
        barrier();  // rank 0 has answered everybody
        list.reset();
        if (mpi_.rank() == 0)
            mpi_.while_waiting = [&] { report(options_.progress, {"merge", 0, 0, 0}); };
    }

    TileRange ask_for_work(const Done& done) {
        TileRange range;
        mpi_.send(0, kRequest, &done, sizeof done);
        mpi_.receive(0, kWork, &range, sizeof range);
        return range;
    }

    /// The parts of this rank's stretch of the tiles: its own and what others have of it. All ranks
    /// go through the same list in the same order, so nobody waits for somebody who waits.
    std::vector<std::unique_ptr<PartFile>> collect_stretch() {
        const std::vector<Located> parts = locate(mpi_, parts_);
        std::uint64_t total = 0, before = 0;
        for (const Located& part : parts) total += part.bytes;
        std::vector<std::unique_ptr<PartFile>> stretch;
        for (const Located& part : parts) {
            const auto owner = static_cast<int>(before * static_cast<std::uint64_t>(mpi_.ranks()) /
                                                std::max<std::uint64_t>(1, total));
            before += part.bytes;
            std::unique_ptr<PartFile> mine;
            if (part.rank == mpi_.rank()) mine = take_part(part.tiles.begin);
            if (owner == mpi_.rank()) {
                stretch.push_back(mine ? std::move(mine) : receive_part(part.rank));
            } else if (mine) {
                send_part(owner, *mine);
            }
        }
        return stretch;
    }

    std::unique_ptr<PartFile> take_part(std::uint64_t first_tile) {
        for (auto& part : parts_)
            if (part && part->state().first_tile == first_tile) return std::move(part);
        throw Error(Errc::io, scratch_.folder(), "a part has disappeared");
    }

    std::unique_ptr<PartFile> merge_own(std::vector<std::unique_ptr<PartFile>> stretch) {
        if (stretch.empty()) return nullptr;
        return merge_into_one(std::move(stretch), scratch_, limits_, options_.progress);
    }

    /// Ranks whose number has the bit send to the neighbour on their left, which has the tiles
    /// before theirs.
    std::unique_ptr<PartFile> merge_pairwise(std::unique_ptr<PartFile> merged) {
        for (int step = 1; step < mpi_.ranks(); step *= 2) {
            if ((mpi_.rank() & step) != 0) {
                send_part_or_none(mpi_.rank() - step, merged.get());
                return nullptr;
            }
            if (mpi_.rank() + step >= mpi_.ranks()) continue;
            std::unique_ptr<PartFile> right = receive_part(mpi_.rank() + step);
            std::vector<std::unique_ptr<PartFile>> both;
            if (merged) both.push_back(std::move(merged));
            if (right) both.push_back(std::move(right));
            merged = merge_own(std::move(both));
        }
        return merged;
    }

    void send_part_or_none(int to, const PartFile* part) {
        if (part != nullptr) return send_part(to, *part);
        const std::uint64_t none = 0;
        mpi_.send(to, kPartSize, &none, sizeof none);
    }

    void send_part(int to, const PartFile& part) {
        const std::uint64_t size = part.file_bytes();
        mpi_.send(to, kPartSize, &size, sizeof size);
        std::vector<char> buffer(std::min(kMessageBytes, size));
        for (std::uint64_t done = 0; done < size;) {
            const std::uint64_t count = std::min<std::uint64_t>(buffer.size(), size - done);
            if (!part.file().read(done, buffer.data(), count))
                throw Error(Errc::io, part.file().path(), "this part of the scratch is cut");
            mpi_.send(to, kPartBytes, buffer.data(), count);
            done += count;
        }
    }

    std::unique_ptr<PartFile> receive_part(int from) {
        std::uint64_t size = 0;
        mpi_.receive(from, kPartSize, &size, sizeof size);
        if (size == 0) return nullptr;
        auto file =
            std::make_shared<SpillFile>(scratch_.folder() / "received", SpillFile::Kind::temporary);
        std::vector<char> buffer(std::min(kMessageBytes, size));
        for (std::uint64_t done = 0; done < size;) {
            const std::uint64_t count = std::min<std::uint64_t>(buffer.size(), size - done);
            mpi_.receive(from, kPartBytes, buffer.data(), count);
            file->write(done, buffer.data(), count);
            done += count;
        }
        auto part = PartFile::adopt(std::move(file), scratch_.key(), scratch_.top());
        if (!part)
            throw Error(Errc::bad_input, "rank " + std::to_string(from) + " sent a damaged part");
        return part;
    }

    Constructed empty() {
        NodeStore store(depth_ - 2);
        Constructed result;
        result.dag = std::move(store).freeze(depth_);
        result.statistics = compute_statistics(result.dag);
        return result;
    }

    void barrier() { (void)mpi_.gather_everywhere({}); }

    void show(const char* phase, const Done& done) {
        report(options_.progress, {phase, done.tiles, source_.tiles().size(), done.voxels});
    }

    static constexpr std::uint64_t kMessageBytes = std::uint64_t{4} << 20;

    MpiSession& mpi_;
    const VoxelSource& source_;
    int depth_;
    const BuildOptions& options_;
    MemoryLimits limits_;
    Scratch& scratch_;
    std::vector<std::unique_ptr<PartFile>> parts_;  // that this rank has
    std::vector<TileRange> runs_;
    Done done_;
};

/// @param disposable  the scene, if it may be given up once it is not needed; or null
MpiBuildResult build_from(MpiSession& mpi, const Scene& scene, Scene* disposable,
                          const BuildOptions& options) {
    if (options.scratch.empty())
        throw Error(Errc::bad_argument, "a build on many machines needs a scratch folder");
    MpiBuildResult result;
    with_threads(options.threads, [&] {
        BuildPlan plan = plan_build(scene, options);
        // Machines may differ in what they would choose.
        const auto plans =
            mpi.gather_everywhere({static_cast<std::uint64_t>(plan.tile_depth), plan.key});
        BuildOptions agreed = options;
        agreed.tile = 1u << plans[0][0];
        plan = plan_build(scene, agreed);
        for (const auto& other : mpi.gather_everywhere({plan.key}))
            if (other[0] != plan.key)
                throw Error(Errc::bad_argument, "the ranks do not have the same scene and options");

        Scratch scratch(options.scratch, plan.key, plan.tile_depth - 2,
                        mpi.rank() == 0 ? Scratch::Use::alone : Scratch::Use::shared);
        const SortedTriangles sorted = sort_triangles(scene, disposable, plan, agreed, scratch);
        Constructed constructed =
            RankBuild(mpi, *sorted.source, plan.grid.depth, agreed, scratch).run();
        mpi.while_waiting = nullptr;
        for (const auto& sent : mpi.gather_everywhere({mpi.sent_bytes()}))
            result.sent_bytes += sent[0];
        result.built = {std::move(constructed.dag),
                        std::move(constructed.statistics),
                        plan.grid,
                        sorted.count,
                        sorted.degenerate,
                        sorted.non_finite};
        if (mpi.rank() == 0 && !options.keep_scratch) scratch.remove();
    });
    return result;
}

}  // namespace

MpiBuildResult build_with_mpi(MpiSession& mpi, const Scene& scene, const BuildOptions& options) {
    return build_from(mpi, scene, nullptr, options);
}

MpiBuildResult build_with_mpi_and_release(MpiSession& mpi, Scene& scene,
                                          const BuildOptions& options) {
    return build_from(mpi, scene, &scene, options);
}

}  // namespace octavo
