#include "engine/device/drivers/serial_link.hpp"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <linux/serial.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "engine/device/drivers/port_holder.hpp"

namespace palpate::engine {

std::string port_trouble(const std::string& path, int error) {
    switch (error) {
        case ENOENT:
        case ENODEV:
        case ENXIO:
        case EIO:
            return "there is no device at " + path +
                   ": is the board plugged in and switched on? `ls /dev/ttyACM* /dev/ttyUSB*` "
                   "lists "
                   "the ports";
        case EACCES:
        case EPERM:
            return "no permission to use " + path +
                   ": join the group palpate that the Debian package makes (`sudo usermod -aG "
                   "palpate $USER`), or the port's own (`sudo usermod -aG dialout $USER`), and log "
                   "in again";
        case EBUSY:
        case EWOULDBLOCK:
            if (const std::string holder = port_holder(path); !holder.empty()) {
                return path + " is in use by another program, " + holder +
                       ", which could give force as well: end it and try again";
            }
            return path + " is in use by another program: end that one (`fuser -v " + path +
                   "` names it) and try again";
        case ENOTTY:
        case EINVAL:
        case EISDIR:
            return path + " is not a serial port: give the board's, such as /dev/ttyACM0";
        default:
            return path + " cannot be used: " + std::strerror(error);
    }
}

/// errno, or 0.
int SerialLink::configure() const noexcept {
    termios raw{};
    if (tcgetattr(port_, &raw) != 0) {
        return ENOTTY;
    }
    if (ioctl(port_, TIOCEXCL) != 0 || flock(port_, LOCK_EX | LOCK_NB) != 0) {
        return errno;
    }
    cfmakeraw(&raw);
    cfsetspeed(&raw, megabaud_ ? B1000000 : B115200);
    raw.c_cflag |= CLOCAL | CREAD;
    raw.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS | HUPCL);
    raw.c_cc[VMIN] = 1;  // nothing there is EAGAIN, so that 0 bytes mean a hang-up
    raw.c_cc[VTIME] = 0;
    if (tcsetattr(port_, TCSANOW, &raw) != 0) {
        return errno;
    }
    serial_struct chip{};
    if (megabaud_ && ioctl(port_, TIOCGSERIAL, &chip) == 0) {
        chip.flags = static_cast<int>(static_cast<unsigned>(chip.flags) |
                                      ASYNC_LOW_LATENCY);  // an FTDI chip would gather for 16 ms
        ioctl(port_, TIOCSSERIAL, &chip);
    }
    return 0;
}

bool SerialLink::reopen() {
    close();
    port_ = ::open(path_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    int error = port_ < 0 ? errno : configure();
    if (error == 0 && !port_holder(path_).empty()) {  // who had it open before the locks
        error = EBUSY;
        ioctl(port_, TIOCNXCL);
    }
    if (error == 0) {
        trouble_.clear();
        drain();
        return true;
    }
    if (port_ >= 0) {  // not by close(): the port may be another's, whose TIOCEXCL stays
        ::close(port_);
        port_ = -1;
    }
    trouble_ = port_trouble(path_, error);
    return false;
}

void SerialLink::close() noexcept {
    if (port_ >= 0) {
        ioctl(port_, TIOCNXCL);
        ::close(port_);
        port_ = -1;
    }
}

bool SerialLink::send(std::span<const std::uint8_t> packet) noexcept {
    ssize_t sent = -1;
    do {
        sent = ::write(port_, packet.data(), packet.size());
    } while (sent < 0 && errno == EINTR);
    return sent == static_cast<ssize_t>(packet.size());
}

bool SerialLink::is_gone(std::ptrdiff_t got, int error) const noexcept {
    return got == 0 || (error != EAGAIN && error != EINTR);
}

}  // namespace palpate::engine
