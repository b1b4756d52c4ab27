#include "ui/rig/say.hpp"

#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <mutex>
#include <string_view>
#include <thread>

#include <unistd.h>

#include "engine/base/text.hpp"
#include "ui/rig/interrupt.hpp"

namespace palpate::ui {
namespace {

/// What is said to one descriptor, written by a thread of its own: that one may wait for ever.
class Passing {
public:
    explicit Passing(int descriptor) : descriptor_(descriptor) {
        std::thread([this] { live(); }).detach();
    }

    /// Written when this returns, unless the reader is slow.
    void say(const std::string& text) {
        std::unique_lock own(mutex_);
        slow_ = slow_ && !idle();
        if (waiting_.size() + text.size() > kUnread) {
            ++left_out_;
            return;
        }
        mark_left_out();
        waiting_ += text;
        ++texts_;
        changed_.notify_all();
        slow_ = slow_ || !changed_.wait_for(own, kMoment, [this] { return idle(); });
    }

    /// Waits for the reader, if no signal comes. @return texts that nobody read
    std::size_t finish() {
        std::unique_lock own(mutex_);
        mark_left_out();
        changed_.notify_all();
        while (!changed_.wait_for(own, kMoment, [this] { return idle(); }) && !interrupted()) {
        }
        return idle() ? 0 : texts_;
    }

    [[nodiscard]] bool failed() const { return failed_; }

private:
    static constexpr std::size_t kUnread = std::size_t{64} * 1024;
    static constexpr auto kMoment = std::chrono::milliseconds(50);

    [[nodiscard]] bool idle() const { return texts_ == 0; }

    void mark_left_out() {
        if (left_out_ > 0) {
            waiting_ += fmt::format("palpate: nobody read this: {} left out here\n",
                                    counted(left_out_, "text"));
            ++texts_;
            left_out_ = 0;
        }
    }

    void live() {
        for (std::unique_lock own(mutex_);;) {
            changed_.wait(own, [this] { return !waiting_.empty(); });
            const std::string text = std::exchange(waiting_, {});
            const std::size_t texts = texts_;
            own.unlock();
            put(text);
            own.lock();
            texts_ -= texts;
            changed_.notify_all();
        }
    }

    void put(std::string_view text) {
        while (!text.empty()) {
            const ssize_t done = write(descriptor_, text.data(), text.size());
            if (done < 0 && errno != EINTR) {
                failed_ = true;
                return;
            }
            text.remove_prefix(done > 0 ? static_cast<std::size_t>(done) : 0);
        }
    }

    int descriptor_;
    std::mutex mutex_{};
    std::condition_variable changed_{};
    std::string waiting_{};     ///< not begun to be written
    std::size_t texts_ = 0;     ///< in it, and in what is being written
    std::size_t left_out_ = 0;  ///< since it was full
    bool slow_ = false;         ///< the reader: nobody waits for it before it has read all
    std::atomic<bool> failed_{false};
};

/// Until the process ends: their threads may stand in write() then.
std::atomic<Passing*> passing_out{nullptr};
std::atomic<Passing*> passing_error{nullptr};

void put(std::FILE* file, const std::string& text) noexcept {
    Passing* passing = file == stdout ? passing_out.load()
                     : file == stderr ? passing_error.load()
                                      : nullptr;
    try {
        if (passing != nullptr) {
            passing->say(text);
            return;
        }
    } catch (const std::exception&) {  // no memory: nobody hears it
        return;
    }
    static_cast<void>(std::fwrite(text.data(), 1, text.size(), file));
    static_cast<void>(std::fflush(file));
}

}  // namespace

void say_to(std::FILE* file, const std::string& text) noexcept {
    put(file, plain(text, Lines::kept));
}

void say_in_passing() {
    std::fflush(stdout);
    passing_out = new Passing(STDOUT_FILENO);
    passing_error = new Passing(STDERR_FILENO);
}

bool let_readers_read() noexcept {
    if (passing_out == nullptr || passing_error == nullptr) {
        return true;
    }
    try {
        if (const std::size_t unread = passing_out.load()->finish(); unread > 0) {
            warn("nobody read standard output: the last {} said there are lost",
                 counted(unread, "text"));
        }
        passing_error.load()->finish();
    } catch (const std::exception&) {  // no memory
        return false;
    }
    return !passing_out.load()->failed();
}

void ring() noexcept {
    if (isatty(STDERR_FILENO) == 1) {
        put(stderr, "\a");
    }
}

}  // namespace palpate::ui
