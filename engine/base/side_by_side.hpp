#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace palpate {

/// Processors on which the calling thread may run: fewer than the machine has within what a batch
/// system, a container or taskset leaves it. At least 1.
[[nodiscard]] std::size_t usable_processors() noexcept;

/// Work that is done side by side: by a thread for each further core, and by whoever waits for some
/// of it. Tasks begin in the order in which they were added, and must not depend on one another.
/// One owner.
class SideBySide {
public:
    /// @param cores  of which one is the owner's; 1: who waits does it all
    explicit SideBySide(std::size_t cores = usable_processors());
    /// What has not begun by now is left out.
    ~SideBySide();

    /// @return the task's number, from 0. What it refers to must live until it is done
    std::size_t add(std::function<void()> task);

    /// Returns once a task is done, and works on what was added until then.
    /// @throws what the task threw
    void wait_for(std::size_t number);

private:
    using Lock = std::unique_lock<std::mutex>;
    struct Task {
        std::function<void()> work;
        std::exception_ptr error{};
        bool done = false;
    };

    bool work(Lock& lock) noexcept;
    void work_until_the_end() noexcept;

    std::mutex mutex_;  ///< of all that follows, but for a task that is being worked on
    std::condition_variable changed_;
    std::deque<Task> tasks_;  ///< none of them moves
    std::size_t begun_ = 0;
    bool ends_ = false;
    std::vector<std::thread> threads_;
};

/// Work on 0 ... count - 1 by several threads, the caller's among them, each number once.
/// @throws what the first of them threw; what has not begun by then is left out
void for_each_number(std::size_t threads,
                     std::size_t count,
                     const std::function<void(std::size_t)>& work);

}  // namespace palpate
