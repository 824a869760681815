// SPDX-License-Identifier: MIT
#include "octavo/core/parallel.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <stdexcept>

namespace octavo {
namespace {

TEST(WithThreads, GivesTheWorkAsManyAsAskedFor) {
    for (const int threads : {1, 3, 9}) {
        int seen = 0;
        with_threads(threads, [&] { seen = tbb::this_task_arena::max_concurrency(); });
        EXPECT_EQ(seen, threads);
    }
}

TEST(WithThreads, LetsExceptionsThrough) {
    EXPECT_THROW(with_threads(2, [] { throw std::runtime_error("x"); }), std::runtime_error);
}

}  // namespace
}  // namespace octavo
