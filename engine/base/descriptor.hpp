#pragma once

#include <cstddef>
#include <span>
#include <utility>

#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

namespace palpate {

/// An open file of the kernel's, closed at the end. Whatever holds one moves, and is not copied.
class Descriptor {
public:
    /// @param number  < 0: none
    explicit Descriptor(int number = -1) noexcept : number_(number) {}
    Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
        std::swap(number_, other.number_);
        return *this;
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() {
        if (number_ >= 0) {
            close(number_);
        }
    }
    [[nodiscard]] int get() const noexcept { return number_; }

private:
    int number_;
};

/// Sends bytes in one piece to another process of this machine, and with them an open file, as
/// sendmsg(2) does. Also after a fork.
/// @param file  < 0: none
[[nodiscard]] ssize_t send_with_file(int socket,
                                     std::span<iovec> parts,
                                     int file,
                                     int flags) noexcept;
/// The other side, as recvmsg(2). @param file  gets what came with the bytes; none: it stays
[[nodiscard]] ssize_t receive_with_file(int socket,
                                        std::span<std::byte> into,
                                        int& file,
                                        int flags) noexcept;

}  // namespace palpate
