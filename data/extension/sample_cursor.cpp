#include "data/extension/sample_cursor.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace palpate::data {

using engine::TickRecord;

void SampleCursor::start(const SampleScan& scan) {
    scan_ = scan;
    tick_ = nullptr;
    blocks_.reset();
    merged_.reset();
    next_part_ = 0;
    parts_ = scan.nothing ? std::vector<TrialPart>() : store_->parts(scan.trials);
    std::erase_if(parts_, [&scan](const TrialPart& part) {
        return scan.interval && part.interval != *scan.interval;
    });
    next_part();
}

void SampleCursor::next_part() {
    while (tick_ == nullptr && next_part_ < parts_.size()) {
        const bool several = next_part_ + 1 < parts_.size() &&
                             parts_[next_part_ + 1].trial == parts_[next_part_].trial;
        if (several && (scan_.by_time || scan_.by_tick)) {
            merge_trial();
            continue;
        }
        part_ = parts_[next_part_++];
        blocks_ = store_->blocks(part_, scan_.columns, scan_.range);
        has_last_ = false;
        block_ = {};
        at_ = 0;
        next_block();
    }
}

void SampleCursor::next_block() {
    if (!block_.empty()) {
        last_ = block_.back();
        has_last_ = true;
    }
    block_ = blocks_->next();
    at_ = 0;
    tick_ = block_.empty() ? nullptr : block_.data();
}

void SampleCursor::next() {
    if (merged_) {
        next_merged();
        return;
    }
    if (++at_ < block_.size()) {
        tick_ = &block_[at_];
        return;
    }
    next_block();
    if (tick_ == nullptr) {
        next_part();
    }
}

void SampleCursor::merge_trial() {
    MergedRows& all = merged_.emplace();
    const std::int64_t trial = parts_[next_part_].trial;
    for (; next_part_ < parts_.size() && parts_[next_part_].trial == trial; ++next_part_) {
        const auto blocks = store_->blocks(parts_[next_part_], scan_.columns, scan_.range);
        for (auto block = blocks->next(); !block.empty(); block = blocks->next()) {
            all.rows.insert(all.rows.end(), block.begin(), block.end());
        }
        all.of.resize(all.rows.size(), parts_[next_part_]);
    }
    all.order.resize(all.rows.size());
    std::iota(all.order.begin(), all.order.end(), std::size_t{0});
    std::ranges::stable_sort(all.order, [&](std::size_t a, std::size_t b) {
        return scan_.by_time ? all.rows[a].time_ns < all.rows[b].time_ns
                             : all.rows[a].tick < all.rows[b].tick;
    });
    at_ = std::numeric_limits<std::size_t>::max();  // before the first
    next_merged();
}

void SampleCursor::next_merged() {
    if (++at_ < merged_->order.size()) {
        const std::size_t row = merged_->order[at_];
        tick_ = &merged_->rows[row];
        part_ = merged_->of[row];
        has_last_ = row > 0 && merged_->of[row - 1] == part_;
        last_ = has_last_ ? merged_->rows[row - 1] : TickRecord{};
        return;
    }
    merged_.reset();
    tick_ = nullptr;
    next_part();
}

engine::Vec3 SampleCursor::velocity() const noexcept {
    const bool inside = !merged_ && at_ > 0;
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    if (!inside && !has_last_) {
        return {kNone, kNone, kNone};
    }
    const TickRecord& before = inside ? block_[at_ - 1] : last_;
    const double time = static_cast<double>(tick_->time_ns - before.time_ns) * 1e-9;
    if (!(time > 0.0)) {
        return {kNone, kNone, kNone};
    }
    return (tick_->hip - before.hip) / time;
}

}  // namespace palpate::data
