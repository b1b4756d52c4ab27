#pragma once

#include <fcntl.h>
#include <unistd.h>

namespace palpate::ui {

/// Sends standard error nowhere while it lives: sound libraries write pages there when there is no
/// sound, and what matters of it is in SDL's error.
class Hush {
public:
    /// Nothing happens where there is no /dev/null. One at a time.
    Hush() : saved_(dup(STDERR_FILENO)), nowhere_(open("/dev/null", O_WRONLY | O_CLOEXEC)) {
        if (saved_ >= 0 && nowhere_ >= 0) {
            dup2(nowhere_, STDERR_FILENO);
        }
    }
    Hush(const Hush&) = delete;
    Hush& operator=(const Hush&) = delete;
    ~Hush() {
        if (saved_ >= 0) {
            dup2(saved_, STDERR_FILENO);
            close(saved_);
        }
        if (nowhere_ >= 0) {
            close(nowhere_);
        }
    }

private:
    int saved_;
    int nowhere_;
};

}  // namespace palpate::ui
