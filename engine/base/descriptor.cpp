#include "engine/base/descriptor.hpp"

#include <array>
#include <cstring>

#include <sys/socket.h>

namespace palpate {
namespace {

/// For one open file beside the bytes.
struct alignas(cmsghdr) Room {
    std::array<char, CMSG_SPACE(sizeof(int))> bytes{};
};

msghdr head_of(std::span<iovec> parts, Room& room) noexcept {
    msghdr head{};
    head.msg_iov = parts.data();
    head.msg_iovlen = parts.size();
    head.msg_control = room.bytes.data();
    head.msg_controllen = room.bytes.size();
    return head;
}

}  // namespace

ssize_t send_with_file(int socket, std::span<iovec> parts, int file, int flags) noexcept {
    Room room;
    msghdr head = head_of(parts, room);
    cmsghdr* beside = CMSG_FIRSTHDR(&head);
    beside->cmsg_level = SOL_SOCKET;
    beside->cmsg_type = SCM_RIGHTS;
    beside->cmsg_len = CMSG_LEN(sizeof file);
    std::memcpy(CMSG_DATA(beside), &file, sizeof file);
    head.msg_controllen = file < 0 ? 0 : head.msg_controllen;
    return sendmsg(socket, &head, flags);
}

ssize_t receive_with_file(int socket, std::span<std::byte> into, int& file, int flags) noexcept {
    Room room;
    iovec part{.iov_base = into.data(), .iov_len = into.size()};
    msghdr head = head_of({&part, 1}, room);
    const ssize_t got = recvmsg(socket, &head, flags);
    const cmsghdr* beside = got > 0 ? CMSG_FIRSTHDR(&head) : nullptr;
    if (beside != nullptr && beside->cmsg_type == SCM_RIGHTS) {
        std::memcpy(&file, CMSG_DATA(beside), sizeof file);
    }
    return got;
}

}  // namespace palpate
