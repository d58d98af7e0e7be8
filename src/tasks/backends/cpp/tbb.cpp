// The C++ side of the oneTBB back-end: an arena of a pool's threads and one group for its tasks. See ../tbb.rs, which declares all this.
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <mutex>

namespace {

// Runs a task on the thread of this id; catches what the task throws.
using Run = void (*)(const void *engine, void *job, int thread);
// What is called inside the arena.
using Body = void (*)(void *body, int thread);

// Lets oneTBB have as many threads as the largest pool so far, more than there are cores if need be. Of several controls it heeds the
// least, so there is one for all pools; it stays to the end, since threads that are not used only sleep.
void allow(int threads) {
    static std::mutex mutex;
    static int allowed = 0;
    static tbb::global_control *control = nullptr;
    const std::lock_guard<std::mutex> lock(mutex);
    if (threads > allowed) {
        delete control;
        control = new tbb::global_control(tbb::global_control::max_allowed_parallelism, threads);
        allowed = threads;
    }
}

struct Arena {
    // With one place kept for who opens a region.
    explicit Arena(int threads) : arena(threads, 1) { allow(threads); }

    tbb::task_arena arena;
    tbb::task_group group;
};

} // namespace

// An exception that leaves a noexcept function ends the program: it can only be that memory is out.
extern "C" {

Arena *geo_adapt_tbb_new(int threads) noexcept { return new Arena(threads); }

void geo_adapt_tbb_delete(Arena *arena) noexcept { delete arena; }

// Calls the body as one of the arena's threads and waits for all tasks.
void geo_adapt_tbb_region(Arena *arena, void *body, Body call) noexcept {
    arena->arena.execute([=] {
        call(body, tbb::this_task_arena::current_thread_index());
        arena->group.wait();
    });
}

void geo_adapt_tbb_push(Arena *arena, const void *engine, void *job, Run run) noexcept {
    arena->group.run([=] { run(engine, job, tbb::this_task_arena::current_thread_index()); });
}

void geo_adapt_tbb_wait(Arena *arena) noexcept { arena->group.wait(); }

} // extern "C"
