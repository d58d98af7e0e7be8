// The C++ side of the OpenMP back-end. See ../openmp.rs, which declares all this.
#include <omp.h>

namespace {

// Runs a task on the thread of this id; catches what the task throws.
using Run = void (*)(const void *engine, void *job, int thread);
// What is called inside the parallel region.
using Body = void (*)(void *body, int thread);

} // namespace

extern "C" {

// Calls the body as one of so many threads; the others run tasks meanwhile. The barrier at the end waits for all tasks.
void geo_adapt_openmp_region(int threads, void *body, Body call) noexcept {
#pragma omp parallel num_threads(threads)
    {
#pragma omp master
        call(body, omp_get_thread_num());
    }
}

// A task is tied, as by default: it ends on the thread on which it began. OpenMP may run it at once.
void geo_adapt_openmp_push(const void *engine, void *job, Run run) noexcept {
#pragma omp task firstprivate(engine, job, run)
    run(engine, job, omp_get_thread_num());
}

// Waits for those tasks that the body itself made.
void geo_adapt_openmp_wait() noexcept {
#pragma omp taskwait
}

} // extern "C"
