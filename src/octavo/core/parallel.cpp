// SPDX-License-Identifier: MIT
#include "octavo/core/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace octavo {

int available_threads() {
    return std::max(1, tbb::info::default_concurrency());
}

void with_threads(int threads, const std::function<void()>& work) {
    const int count = threads > 0 ? threads : available_threads();
    // An arena alone cannot have more workers than oneTBB's global limit, which is the core count:
    // lift that too, so that tests can ask for more threads than the machine has cores.
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(std::max(count, available_threads())));
    tbb::task_arena arena(count);
    arena.execute(work);
}

}  // namespace octavo
