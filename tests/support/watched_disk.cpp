#include "tests/support/watched_disk_state.hpp"

namespace palpate::tests {

std::mutex watch_guard;  // NOLINT: the C library's functions have no other place
std::atomic<WatchedDisk::State*> watched_disk;  // NOLINT

WatchedDisk::WatchedDisk(const std::filesystem::path& folder)
    : state_(std::make_unique<State>(folder)) {
    watched_disk = state_.get();
}

WatchedDisk::~WatchedDisk() {
    stop();
}

void WatchedDisk::stop() {
    const std::scoped_lock lock(watch_guard);
    watched_disk = nullptr;
}

std::size_t WatchedDisk::tried() const {
    const std::scoped_lock lock(watch_guard);
    return state_->count;
}

std::size_t WatchedDisk::calls() const {
    const std::scoped_lock lock(watch_guard);
    return state_->log.size();
}

const std::vector<DiskCall>& WatchedDisk::log() const {
    return state_->log;
}

const DiskModel& WatchedDisk::before() const {
    return state_->before;
}

void WatchedDisk::fail(std::size_t call, int error, bool for_good) {
    const std::scoped_lock lock(watch_guard);
    state_->failing = call;
    state_->error = error;
    state_->for_good = for_good;
}

void WatchedDisk::room(std::int64_t bytes) {
    const std::scoped_lock lock(watch_guard);
    state_->room = bytes;
}

}  // namespace palpate::tests
