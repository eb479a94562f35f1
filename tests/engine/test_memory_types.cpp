// Which memory types buffers lie in, and how much memory counts, on devices that are not at hand.
#include "engine/memory_types.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rosefusion::testing {
namespace test_memory_types {

using ::testing::ElementsAre;

constexpr VkMemoryPropertyFlags D = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT,
                                V = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT,
                                C = VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
                                H = VK_MEMORY_PROPERTY_HOST_CACHED_BIT,
                                kProtected = VK_MEMORY_PROPERTY_PROTECTED_BIT,
                                kSlow = VK_MEMORY_PROPERTY_DEVICE_COHERENT_BIT_AMD,
                                kUncached = VK_MEMORY_PROPERTY_DEVICE_UNCACHED_BIT_AMD;
constexpr std::uint64_t kMiB = 1 << 20, kGiB = 1 << 30, kLarge = 64 * kMiB;

struct Heap {
  std::uint64_t bytes;
  bool device_local;
};

VkPhysicalDeviceMemoryProperties made(std::vector<Heap> heaps, std::vector<VkMemoryType> types) {
  VkPhysicalDeviceMemoryProperties out{};
  for (const Heap& heap : heaps)
    out.memoryHeaps[out.memoryHeapCount++] = {
        heap.bytes, VkMemoryHeapFlags(heap.device_local ? VK_MEMORY_HEAP_DEVICE_LOCAL_BIT : 0)};
  for (const VkMemoryType& type : types) out.memoryTypes[out.memoryTypeCount++] = type;
  return out;
}

// As Mesa's RADV lists them on a card whose memory the host sees a part of.
const auto kCard =
    made({{8 * kGiB, true}, {16 * kGiB, false}, {256 * kMiB, true}}, {{D, 0},
                                                                      {V | C, 1},
                                                                      {D | V | C, 2},
                                                                      {V | C | H, 1},
                                                                      {D | kSlow | kUncached, 0},
                                                                      {V | C | kSlow | kUncached, 1}});
// An APU of which 512 MiB are set apart.
const auto kApu = made({{512 * kMiB, true}, {12 * kGiB, false}}, {{D, 0}, {V | C, 1}, {V | C | H, 1}});
// Where no type is cached and coherent.
const auto kPhone = made({{4 * kGiB, true}}, {{D | kProtected, 0}, {D, 0}, {D | V | C, 0}, {D | V | H, 0}});

TEST(MemoryTypes, ABufferOfTheDevicesLiesInItsMemoryFirst) {
  EXPECT_THAT(memoryTypesFor(Memory::Device, kLarge, kCard, ~0u), ElementsAre(0, 2, 1, 3));
  EXPECT_THAT(memoryTypesFor(Memory::Device, kLarge, kApu, ~0u), ElementsAre(0, 1, 2));
}

TEST(MemoryTypes, ThoseForOtherEndsAreLeftOut) {
  EXPECT_THAT(memoryTypesFor(Memory::Device, kLarge, kPhone, ~0u), ElementsAre(1, 2, 3));
  const auto slow_first = made({{kGiB, true}}, {{D | V | C | kSlow, 0},
                                                {D | V | C | kUncached, 0},
                                                {D | VK_MEMORY_PROPERTY_LAZILY_ALLOCATED_BIT, 0},
                                                {D | V | C, 0}});
  for (const Memory use : {Memory::Device, Memory::Upload, Memory::Readback})
    EXPECT_THAT(memoryTypesFor(use, 1024, slow_first, ~0u), ElementsAre(3));
}

TEST(MemoryTypes, OnlyThoseThatTheBufferMayLieIn) {
  EXPECT_THAT(memoryTypesFor(Memory::Device, kLarge, kCard, 0b1110), ElementsAre(2, 1, 3));
  EXPECT_THAT(memoryTypesFor(Memory::Upload, kLarge, kCard, 0b0001), ElementsAre());
}

TEST(MemoryTypes, ParametersLieBesideTheProcessors) {
  EXPECT_THAT(memoryTypesFor(Memory::Upload, 256, kCard, ~0u), ElementsAre(2, 1, 3));
  EXPECT_THAT(memoryTypesFor(Memory::Upload, kLarge, kCard, ~0u), ElementsAre(1, 2, 3));
}

TEST(MemoryTypes, WhatIsReadBackIsCached) {
  EXPECT_THAT(memoryTypesFor(Memory::Readback, 256, kCard, ~0u), ElementsAre(3, 1, 2));
  EXPECT_THAT(memoryTypesFor(Memory::Readback, 256, kPhone, ~0u), ElementsAre(3, 2));
}

TEST(MemoryTypes, TheHostsHeapCountsWhereItIsTheDevicesToo) {
  EXPECT_EQ(usableBytes(kCard, nullptr, DeviceType::Discrete), 8 * kGiB + 256 * kMiB);
  EXPECT_EQ(usableBytes(kApu, nullptr, DeviceType::Integrated), 12 * kGiB + 512 * kMiB);
  EXPECT_EQ(usableBytes(kPhone, nullptr, DeviceType::Integrated), 4 * kGiB);
}

TEST(MemoryTypes, WhatOtherProgramsHoldDoesNotCount) {
  const VkDeviceSize budgets[] = {3 * kGiB, 10 * kGiB, 512 * kMiB};  // the last is more than there is
  EXPECT_EQ(usableBytes(kCard, budgets, DeviceType::Discrete), 3 * kGiB + 256 * kMiB);
}

TEST(MemoryTypes, AHeapWithoutATypeForBuffersDoesNotCount) {
  const auto hidden = made({{2 * kGiB, true}, {kGiB, true}}, {{D, 0}, {D | kProtected, 1}});
  EXPECT_EQ(usableBytes(hidden, nullptr, DeviceType::Discrete), 2 * kGiB);
}

}  // namespace test_memory_types
}  // namespace rosefusion::testing
