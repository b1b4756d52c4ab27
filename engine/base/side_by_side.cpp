#include "engine/base/side_by_side.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include <sched.h>

namespace palpate {

std::size_t usable_processors() noexcept {
    cpu_set_t mine;
    CPU_ZERO(&mine);
    // More than fit in a cpu_set_t, 1024: all of them.
    return ::sched_getaffinity(0, sizeof mine, &mine) == 0
             ? static_cast<std::size_t>(std::max(CPU_COUNT(&mine), 1))
             : std::max<std::size_t>(std::thread::hardware_concurrency(), 1);
}

SideBySide::SideBySide(std::size_t cores) {
    try {
        for (std::size_t i = 1; i < cores; ++i) {
            threads_.emplace_back([this] { work_until_the_end(); });
        }
    } catch (const std::system_error&) {  // then there are fewer
    }
}

SideBySide::~SideBySide() {
    {
        const Lock lock(mutex_);
        ends_ = true;
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) {
        thread.join();
    }
}

std::size_t SideBySide::add(std::function<void()> task) {
    const Lock lock(mutex_);
    tasks_.emplace_back().work = std::move(task);
    changed_.notify_all();
    return tasks_.size() - 1;
}

void SideBySide::wait_for(std::size_t number) {
    Lock lock(mutex_);
    while (!tasks_.at(number).done) {
        if (!work(lock)) {
            changed_.wait(lock);
        }
    }
    if (const std::exception_ptr error = std::exchange(tasks_[number].error, nullptr)) {
        std::rethrow_exception(error);
    }
}

void SideBySide::work_until_the_end() noexcept {
    Lock lock(mutex_);
    while (!ends_) {
        if (!work(lock)) {
            changed_.wait(lock);
        }
    }
}

/// Does the next task. @return false if there is none
bool SideBySide::work(Lock& lock) noexcept {
    if (begun_ == tasks_.size()) {
        return false;
    }
    Task& task = tasks_[begun_++];
    lock.unlock();
    try {
        task.work();
    } catch (...) {
        task.error = std::current_exception();
    }
    task.work = nullptr;
    lock.lock();
    task.done = true;
    changed_.notify_all();
    return true;
}

void for_each_number(std::size_t threads,
                     std::size_t count,
                     const std::function<void(std::size_t)>& work) {
    SideBySide shared(std::min(threads, count));
    for (std::size_t i = 0; i < count; ++i) {
        shared.add([&work, i] { work(i); });
    }
    for (std::size_t i = 0; i < count; ++i) {
        shared.wait_for(i);
    }
}

}  // namespace palpate
