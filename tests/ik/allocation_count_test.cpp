// Replaces the global operator new to count allocations, and holds that the solvers make none.

#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "ik/ik_cases.h"

namespace {

thread_local long allocations = 0;

void* counted_allocation(std::size_t size) {
  ++allocations;
  void* const memory = std::malloc(size == 0 ? 1 : size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t size) {
  return counted_allocation(size);
}
void* operator new[](std::size_t size) {
  return counted_allocation(size);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace retarget {
namespace {

TEST(Solvers, AllocateNothingPerFrame) {
  const auto robot = load_g1();
  const IkCase ik_case = random_case(robot, 12, 3);
  for (const bool fast : {false, true}) {
    const auto solver =
        fast ? make_fast_solver(ik_case.problem) : make_reference_solver(ik_case.problem);
    std::vector<double> qpos = ik_case.start;
    const long before = allocations;
    for (int frame = 0; frame < 20; ++frame) {
      qpos = ik_case.start;
      solver->solve_pass(0, ik_case.targets, qpos);
      solver->solve_pass(1, ik_case.targets, qpos);
    }
    EXPECT_EQ(allocations, before) << (fast ? "fast" : "reference");
  }
}

}  // namespace
}  // namespace retarget
