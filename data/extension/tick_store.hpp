#pragma once

#include <memory>
#include <vector>

#include "data/extension/tick_parts.hpp"
#include "data/trace/sample_columns.hpp"

struct sqlite3;

namespace palpate::data {

/// The ticks in a database that somebody else opened: main of `db`. Reads only. Refuses while
/// another database with ticks is attached.
class TickStore {
public:
    /// @param db  stays the caller's, and outlives this
    explicit TickStore(sqlite3* db);
    TickStore(const TickStore&) = delete;
    TickStore& operator=(const TickStore&) = delete;
    ~TickStore();

    /// Parts with ticks, or of which ticks are counted, in order.
    [[nodiscard]] std::vector<TrialPart> parts(const TrialRange& trials);

    /// The ticks of a part, block by block in order. `columns` says which fields of the ticks are
    /// read; others may hold anything.
    [[nodiscard]] std::unique_ptr<TickBlocks> blocks(const TrialPart& part,
                                                     SampleColumns columns,
                                                     const TickRange& range);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace palpate::data
