#pragma once

#include <string>

#include <sys/types.h>

namespace palpate::ui {

/// Keeps the machine from sleeping for as long as it lives, where systemd is there to be asked: a
/// force that nobody renews while the machine wakes up is nothing to hold. It ends with this
/// program, however that comes: the inhibitor waits for the end of a pipe.
class StayAwake {
public:
    /// Never throws: without systemd the machine may sleep.
    StayAwake();
    StayAwake(const StayAwake&) = delete;
    StayAwake& operator=(const StayAwake&) = delete;
    ~StayAwake();

    /// For the record of a session: whether sleep is held off.
    [[nodiscard]] std::string text() const;

private:
    void start(int in, int out);

    pid_t pid_ = -1;
    int pipe_ = -1;  ///< the inhibitor lives until this is closed
    bool held_ = false;
};

}  // namespace palpate::ui
