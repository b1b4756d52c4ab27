/* A force device of any make as an open board behind a UDP port: a program of your own that links the vendor's SDK,
 * of which palpate knows nothing. Frames, states, watchdog and clamp are board.c's; the seam is sdk_read() and
 * sdk_force(), here a free mass that a line X,Y (mm) on standard input brings to a place. How to: docs/devices.md.
 * palpate speaks of two joints: four links of 0.2 m that nobody has made stand between, place = l e(q1) + l e(q2).
 * udp_device.toml names the same. A device with three axes is held in the plane z = 0 by a spring. */
#define _GNU_SOURCE
#include <arpa/inet.h>
#include <math.h>
#include <poll.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include "engine/device/firmware/board.h"
enum { COUNTS = 1000000, FULL_UN_M = 1000000 }; /* a turn; torque at full duty: as in udp_device.toml */
static const double kLink = 0.2, kReach = 0.3;  /* m: a link; from the joints to the middle of the workspace */
static double place[3], speed[3];               /* of the mass, m, m/s */
static int32_t zero[2]; static int16_t duty[2]; static bool on; /* counts; of BOARD_DUTY; motors are */
static void sdk_read(double at[3]) { memcpy(at, place, sizeof place); }
static void sdk_force(const double newtons[3]) /* for a millisecond, on 0.1 kg with 0.02 N of dry friction */
{
    for (int i = 0; i < 3; ++i) {
        const double pushed = speed[i] + newtons[i] / 0.1 * 1e-3;
        speed[i] = copysign(fmax(fabs(pushed) - 0.02 / 0.1 * 1e-3, 0.0), pushed), place[i] += speed[i] * 1e-3;
    }
}
static double joints(double q[2]) /* where the device is, as joints; returns z */
{
    double at[3];
    sdk_read(at);
    const double y = at[1] + kReach, open = acos(fmin(hypot(at[0], y) / (2.0 * kLink), 1.0));
    q[0] = atan2(y, at[0]) + open, q[1] = atan2(y, at[0]) - open;
    return at[2];
}
static void every_millisecond(struct board *board)
{
    static double last_z;
    double q[2], force[3] = {0.0};
    const double z = joints(q), unit = 1e-6 * FULL_UN_M / BOARD_DUTY / (kLink * sin(q[1] - q[0]));
    board_tick(board);
    if (on) { /* J^T F = torque, solved for F */
        force[0] = unit * (cos(q[1]) * duty[0] - cos(q[0]) * duty[1]);
        force[1] = unit * (sin(q[1]) * duty[0] - sin(q[0]) * duty[1]);
        force[2] = fmax(fmin(-500.0 * z - 2.0 * (z - last_z) / 1e-3, 2.0), -2.0);
    }
    last_z = z;
    sdk_force(force);
}
static int64_t now_us(void)
{
    struct timespec now;
    return clock_gettime(CLOCK_MONOTONIC, &now), now.tv_sec * INT64_C(1000000) + now.tv_nsec / 1000;
}
uint64_t platform_nonce(void) { uint64_t nonce; return getentropy(&nonce, sizeof nonce) != 0 ? abort(), 0 : nonce; }
uint8_t platform_lock(void) { return 0; } /* what board.c asks; there are no interrupts */
void platform_unlock(uint8_t was) { (void)was; }
void platform_motors_off(struct board *board) { (void)board, on = false, duty[0] = duty[1] = 0; }
void platform_motors_on(struct board *board) { (void)board, on = true; }
void platform_duty(struct board *board, uint8_t motor, int16_t steps) { (void)board, duty[motor] = steps; }
bool platform_stop_pressed(struct board *board) { return (void)board, false; } /* the vendor's, if it can be asked */
void platform_sense(struct board *board, struct board_sense *sense)
{
    double q[2];
    (void)board, joints(q);
    *sense = (struct board_sense){.time_us = (uint32_t)now_us()};
    for (int i = 0; i < 2; ++i) sense->count[i] = (int32_t)lround(q[i] / (2.0 * M_PI) * COUNTS) - zero[i];
}
void platform_forget(struct board *board, bool to_zero)
{
    struct board_sense now;
    platform_sense(board, &now);
    for (int i = 0; to_zero && i < 2; ++i) zero[i] += now.count[i];
}
int main(int argc, char **argv)
{
    static const struct board_facts facts = {1, {COUNTS, COUNTS}, {FULL_UN_M, FULL_UN_M}, 2, 1, 1};
    struct sockaddr_in from, here = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK),
                                                 .sin_port = htons((uint16_t)(argc == 2 ? atoi(argv[1]) : 0))};
    struct pollfd in[2] = {{socket(AF_INET, SOCK_DGRAM, 0), POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}};
    struct board board; uint8_t datagram[64], answer[BOARD_DATAGRAM];
    if (argc != 2 || bind(in[0].fd, (struct sockaddr *)&here, sizeof here) != 0)
        return fprintf(stderr, "usage: udp_device PORT, one that is free\n"), 2;
    sched_setscheduler(0, SCHED_FIFO, &(struct sched_param){.sched_priority = 40}); /* where it is permitted */
    board_begin(&board, &facts, NULL);
    for (int64_t next = now_us();;) {
        poll(in, 2, 1);
        for (; next <= now_us(); next += 1000) every_millisecond(&board);
        char line[64] = "";
        double x, y;
        if (in[1].revents != 0 && read(STDIN_FILENO, line, sizeof line - 1) <= 0) in[1].fd = -1;
        if (sscanf(line, "%lf,%lf", &x, &y) == 2) place[0] = 1e-3 * x, place[1] = 1e-3 * y, speed[0] = speed[1] = 0.0;
        socklen_t length = sizeof from;
        const ssize_t got = recvfrom(in[0].fd, datagram, sizeof datagram, MSG_DONTWAIT, (struct sockaddr *)&from, &length);
        const uint64_t who = (uint64_t)from.sin_addr.s_addr << 16 | from.sin_port; /* board.c knows who is heard */
        const uint8_t size = got > 0 ? board_datagram(&board, who, datagram, (uint16_t)got, answer) : 0;
        if (size > 0) sendto(in[0].fd, answer, size, 0, (struct sockaddr *)&from, sizeof from);
    }
}
