// Pass table_entries: new blocks' slots into the page table.
#pragma once
#include <span>

#include "engine/recorder.h"
#include "shaders/compute/interface/table_entries.h"

namespace rosefusion {

class TableEntriesPass {
 public:
  explicit TableEntriesPass(Device& device);

  /// Copies `entries` at once; both tables get them when the commands run.
  void record(Recorder& recorder, std::span<const shader::TableEntry> entries, const Buffer& table,
              const Buffer& request_table);

 private:
  Device& device_;
  Kernel kernel_;
  Buffer entries_;
};

}  // namespace rosefusion
