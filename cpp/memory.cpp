// What is done where C++ finds no memory.
#include "geo-adapt/cpp/occt.hpp"

#include <new>

namespace {
void (*on_memory_end)() = nullptr;

/// It comes back where one request was too large for a machine that has memory left.
void handle()
{
  geo_adapt::memory_ended();
  throw std::bad_alloc();
}
} // namespace

namespace geo_adapt {
void memory_ended()
{
  if (on_memory_end != nullptr) {
    on_memory_end();
  }
}
} // namespace geo_adapt

extern "C" void geo_adapt_on_memory_end(void (*handler)())
{
  on_memory_end = handler;
  std::set_new_handler(handle);
}
