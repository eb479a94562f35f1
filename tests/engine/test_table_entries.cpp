// Pass table_entries: every entry lands in both tables, and nothing else is touched.
#include "engine/passes/table_entries.h"

#include <random>

#include "tests/engine/validating_device.h"

namespace rosefusion::testing {
namespace test_table_entries {

class TableEntries : public ValidatingDevice {};

TEST_F(TableEntries, AreWrittenWhereTheyBelong) {
  constexpr std::uint32_t kSize = 4000, kUntouched = 0xFFFF0000u, kOther = 0xFFFF0001u;
  TableEntriesPass pass(device());
  Recorder recorder(device());
  const Buffer table(device(), 4 * kSize, Memory::Readback), requests(device(), 4 * kSize, Memory::Readback);
  std::vector<std::uint32_t> expected(kSize, kUntouched), order(kSize);
  for (std::uint32_t i = 0; i < kSize; ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), std::mt19937(3));
  recorder.fill(table, kUntouched, 0, table.bytes());
  recorder.fill(requests, kOther, 0, requests.bytes());
  recorder.submit();
  std::uint32_t slot = 1;
  // More than a workgroup, fewer, none, and more than the buffer made for the first.
  for (const std::uint32_t count : {100u, 7u, 0u, 700u}) {
    std::vector<shader::TableEntry> entries;
    for (std::uint32_t i = 0; i < count; ++i, ++slot) {
      entries.push_back({order[slot], slot});
      expected[order[slot]] = slot;
    }
    pass.record(recorder, entries, table, requests);
    recorder.submit();
    const auto written = table.as<std::uint32_t>(), requested = requests.as<std::uint32_t>();
    for (std::uint32_t i = 0; i < kSize; ++i) {
      ASSERT_EQ(written[i], expected[i]) << "entry " << i;
      ASSERT_EQ(requested[i], expected[i] == kUntouched ? kOther : expected[i]);
    }
  }
}

}  // namespace test_table_entries
}  // namespace rosefusion::testing
