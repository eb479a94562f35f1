#include "engine/passes/table_entries.h"

#include <cstring>

namespace rosefusion {

using namespace shader;

TableEntriesPass::TableEntriesPass(Device& device)
    : device_(device),
      kernel_(device, shaderCode("table_entries"), kTableEntriesBindings, sizeof(TableEntriesParams)) {}

void TableEntriesPass::record(Recorder& recorder, std::span<const TableEntry> entries, const Buffer& table,
                              const Buffer& request_table) {
  const Recorder::Whole whole(recorder);
  if (entries.empty()) return;
  if (entries_.bytes() < entries.size_bytes())
    entries_ = Buffer(device_, entries.size_bytes() * 3 / 2, Memory::Upload);
  std::memcpy(entries_.as<char>().data(), entries.data(), entries.size_bytes());
  const auto count = static_cast<std::uint32_t>(entries.size());
  recorder.dispatch(kernel_, {entries_, table, request_table}, TableEntriesParams{count},
                    Groups{(count + kTableEntriesGroup - 1) / kTableEntriesGroup});
}

}  // namespace rosefusion
