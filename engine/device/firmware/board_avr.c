/* The open board on an ATmega328P (Uno, Nano) or ATmega2560 (Mega) at 16 MHz. build.sh makes it; with -DAXES=3 the
 * 2560 drives a third axis.
 *
 *                          ATmega328P      ATmega2560
 *   encoder 1, A and B     PD2 PD3 (D2 D3)  PB0 PB1 (D53 D52)    5 V, quadrature
 *   encoder 2, A and B     PD4 PD5 (D4 D5)  PB2 PB3 (D51 D50)
 *   encoder 3, A and B                     PB4 PB5 (D10 D11)
 *   motor 1 PWM, sign      PB1 PD6 (D9 D6)  PH3 PA0 (D6 D22)     20 kHz; sign high: negative
 *   motor 2 PWM, sign      PB2 PD7 (D10 D7) PH4 PA1 (D7 D23)
 *   motor 3 PWM, sign                      PH5 PA4 (D8 D26)
 *   enable of all drivers  PB0 (D8)         PA2 (D24)            high: on; WITH A PULL-DOWN of 10 kOhm
 *   emergency stop         PC0 (A0)         PA3 (D25)            normally closed to ground
 *   serial port            PD0 PD1          PE0 PE1              1,000,000 baud, 8N1
 *
 * Timer 2 ticks every millisecond; timer 1 (328P) or 4 (2560) makes the PWM.
 */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <avr/wdt.h>

#include "engine/device/firmware/board.h"

#if F_CPU != 16000000UL
#error "baud rate, tick and PWM are those of 16 MHz"
#endif

/* Of the machine at the joints: build.sh takes others. */
#ifndef BOARD_ID
#define BOARD_ID 0
#endif
#ifndef COUNTS_1
#define COUNTS_1 4880
#endif
#ifndef COUNTS_2
#define COUNTS_2 COUNTS_1
#endif
#ifndef COUNTS_3
#define COUNTS_3 COUNTS_1
#endif
#ifndef TORQUE_1_UN_M
#define TORQUE_1_UN_M 123000
#endif
#ifndef TORQUE_2_UN_M
#define TORQUE_2_UN_M TORQUE_1_UN_M
#endif
#ifndef TORQUE_3_UN_M
#define TORQUE_3_UN_M TORQUE_1_UN_M
#endif
#if AXES != 2 && AXES != 3
#error "AXES is 2 or 3"
#endif
#if TORQUE_1_UN_M < 1 || TORQUE_2_UN_M < 1 || TORQUE_3_UN_M < 1
#error "TORQUE_1_UN_M, TORQUE_2_UN_M and TORQUE_3_UN_M are the torque at full duty, 1 or more"
#endif
#if COUNTS_1 < 1 || COUNTS_2 < 1 || COUNTS_3 < 1
#error "COUNTS_1, COUNTS_2 and COUNTS_3 are counts a turn, 1 or more"
#endif

#if defined(__AVR_ATmega328P__)
#if AXES > 2
#error "an ATmega328P has no pins for a third axis: take an ATmega2560"
#endif
#define ENCODERS ((uint8_t)(PIND >> 2) & 15)
#define ENCODER_VECT PCINT2_vect
#define PWM_TOP ICR1
#define PWM_CONNECT TCCR1A
#define PWM_CONNECTS (1 << COM1A1 | 1 << COM1B1)
#define SIGNS PORTD
#define SIGN_PINS (1 << 6 | 1 << 7)
#define ENABLE_PORT PORTB
#define ENABLE (1 << 0)
#define STOP_OPEN (PINC & 1)
#define RX_VECT USART_RX_vect
#define UDRE_VECT USART_UDRE_vect
#elif defined(__AVR_ATmega2560__)
#define ENCODER_PINS (AXES > 2 ? 63 : 15)
#define ENCODERS (PINB & ENCODER_PINS)
#define ENCODER_VECT PCINT0_vect
#define PWM_TOP ICR4
#define PWM_CONNECT TCCR4A
#define PWM_CONNECTS (1 << COM4A1 | 1 << COM4B1 | (AXES > 2 ? 1 << COM4C1 : 0))
#define SIGNS PORTA
#define SIGN_PINS (1 << 0 | 1 << 1 | (AXES > 2 ? 1 << 4 : 0))
#define ENABLE_PORT PORTA
#define ENABLE (1 << 2)
#define STOP_OPEN (PINA & 8)
#define RX_VECT USART0_RX_vect
#define UDRE_VECT USART0_UDRE_vect
#else
#error "a board of this chip has no pins yet: add them here"
#endif

enum { RX_SIZE = 64, TX_SIZE = 128, TICK_STEPS = 250, STEP_US = 4 };

static struct board board;
static struct board_facts facts = {
    .id = BOARD_ID,
#if AXES > 2
    .counts_per_turn = {COUNTS_1, COUNTS_2, COUNTS_3},
    .torque_full = {TORQUE_1_UN_M, TORQUE_2_UN_M, TORQUE_3_UN_M},
#else
    .counts_per_turn = {COUNTS_1, COUNTS_2},
    .torque_full = {TORQUE_1_UN_M, TORQUE_2_UN_M},
#endif
    .axes = AXES,
    .time_step = STEP_US,
};

/* What drives a motor. */
struct output {
    volatile uint16_t *duty;
    uint8_t connect; /* in PWM_CONNECT */
    uint8_t sign;    /* in SIGNS */
};
static const struct output kOutputs[AXES] = {
#if defined(__AVR_ATmega328P__)
    {&OCR1A, 1 << COM1A1, 1 << 6},
    {&OCR1B, 1 << COM1B1, 1 << 7},
#else
    {&OCR4A, 1 << COM4A1, 1 << 0},
    {&OCR4B, 1 << COM4B1, 1 << 1},
#if AXES > 2
    {&OCR4C, 1 << COM4C1, 1 << 4},
#endif
#endif
};

/* Interrupts count in 8 bits, and the tick folds what they counted. */
static volatile uint8_t counted[AXES];
static uint8_t folded[AXES];
static int32_t counts[AXES];
static uint32_t time_us; /* at the last tick */
static volatile uint8_t skipped;
static volatile uint8_t lost;
static volatile uint8_t ticked;

static volatile uint8_t rx[RX_SIZE];
static volatile uint8_t rx_in;
static uint8_t rx_out;
static uint8_t tx[TX_SIZE];
static volatile uint8_t tx_in;
static volatile uint8_t tx_out;

static uint8_t reset_cause __attribute__((section(".noinit")));

/* The chip's watchdog stays on after its own reset, and would fire again before main(). */
void save_reset_cause(void) __attribute__((naked, used, section(".init3")));
void save_reset_cause(void)
{
    reset_cause = MCUSR;
    MCUSR = 0;
    wdt_disable();
}

uint8_t platform_lock(void)
{
    const uint8_t was = SREG;
    cli();
    return was;
}

void platform_unlock(uint8_t was)
{
    SREG = was;
}

void platform_motors_off(struct board *of)
{
    (void)of;
    ENABLE_PORT &= (uint8_t)~ENABLE;
    PWM_CONNECT &= (uint8_t)~PWM_CONNECTS;
}

void platform_motors_on(struct board *of)
{
    (void)of;
    ENABLE_PORT |= ENABLE;
}

/* Fast PWM of 0 would still give a pulse of a cycle: then the pin is disconnected, and low. */
void platform_duty(struct board *of, uint8_t motor, int16_t duty)
{
    const struct output *out = &kOutputs[motor];
    (void)of;
    if (duty == 0) {
        PWM_CONNECT &= (uint8_t)~out->connect;
        return;
    }
    if (duty < 0) {
        SIGNS |= out->sign;
        duty = (int16_t)-duty;
    } else {
        SIGNS &= (uint8_t)~out->sign;
    }
    *out->duty = (uint16_t)(duty - 1);
    PWM_CONNECT |= out->connect;
}

bool platform_stop_pressed(struct board *of)
{
    (void)of;
    return STOP_OPEN != 0;
}

static inline void fold(void)
{
    for (uint8_t i = 0; i < AXES; ++i) {
        const uint8_t now = counted[i];
        counts[i] += (int8_t)(now - folded[i]);
        folded[i] = now;
    }
}

void platform_sense(struct board *of, struct board_sense *sense)
{
    const uint8_t steps = TCNT2;
    (void)of;
    fold();
    sense->time_us = time_us + (uint16_t)(steps * STEP_US);
    if ((TIFR2 & (1 << OCF2A)) != 0 && steps < TICK_STEPS / 2) {
        sense->time_us += 1000; /* the tick is due */
    }
    for (uint8_t i = 0; i < AXES; ++i) {
        sense->count[i] = counts[i];
    }
    sense->skipped_edge = skipped != 0;
    sense->lost_bytes = lost != 0;
}

void platform_forget(struct board *of, bool zero)
{
    (void)of;
    skipped = 0;
    lost = 0;
    fold();
    for (uint8_t i = 0; zero && i < AXES; ++i) {
        counts[i] = 0;
    }
}

/* Encoders and the serial port may interrupt it: neither touches what it does, and they cannot wait. */
ISR(TIMER2_COMPA_vect, ISR_NOBLOCK)
{
    time_us += 1000;
    fold();
    board_tick(&board);
    ticked = 1;
}

/* Step of a quadrature encoder by its old and its new lines; 2: both changed, an edge was missed. */
static const int8_t kStep[16] = {0, 1, -1, 2, -1, 0, 2, 1, 1, 2, 0, -1, 2, -1, 1, 0};
static uint8_t lines;

ISR(ENCODER_VECT)
{
    const uint8_t now = ENCODERS;
    const int8_t first = kStep[(uint8_t)((lines & 3) << 2 | (now & 3))];
    const int8_t second = kStep[(uint8_t)((lines & 12) | (now >> 2 & 3))];
#if AXES > 2
    const int8_t third = kStep[(uint8_t)((lines >> 2 & 12) | now >> 4)];
    counted[2] = (uint8_t)(counted[2] + third);
    if (third == 2) {
        skipped = 1;
    }
#endif
    lines = now;
    counted[0] = (uint8_t)(counted[0] + first);
    counted[1] = (uint8_t)(counted[1] + second);
    if (first == 2 || second == 2) {
        skipped = 1;
    }
}

ISR(RX_VECT)
{
    const uint8_t status = UCSR0A;
    const uint8_t byte = UDR0;
    const uint8_t next = (uint8_t)(rx_in + 1) % RX_SIZE;
    if ((status & (1 << DOR0)) != 0 || next == rx_out) {
        lost = 1;
    }
    if (next != rx_out) {
        rx[rx_in] = byte;
        rx_in = next;
    }
}

ISR(UDRE_VECT)
{
    UDR0 = tx[tx_out];
    tx_out = (uint8_t)(tx_out + 1) % TX_SIZE;
    if (tx_out == tx_in) {
        UCSR0B &= (uint8_t)~(1 << UDRIE0);
    }
}

/* An answer that finds no room is dropped: a board that waits for its host is no watchdog. */
static void send(const uint8_t *bytes, uint8_t size)
{
    const uint8_t waiting = (uint8_t)(tx_in - tx_out) % TX_SIZE;
    if (size >= TX_SIZE - waiting) {
        return;
    }
    for (uint8_t i = 0; i < size; ++i) {
        tx[tx_in] = bytes[i];
        tx_in = (uint8_t)(tx_in + 1) % TX_SIZE;
    }
    const uint8_t lock = platform_lock();
    UCSR0B |= 1 << UDRIE0;
    platform_unlock(lock);
}

static void begin_pins(void)
{
#if defined(__AVR_ATmega328P__)
    PORTD |= 0x3C; /* pull-ups of the encoders, 50 kOhm: enough for open collectors on short wires */
    DDRD |= SIGN_PINS;
    DDRB |= ENABLE | 1 << 1 | 1 << 2;
    PORTC |= 1;
    PCMSK2 = 0x3C;
    PCICR = 1 << PCIE2;
#else
    PORTB |= ENCODER_PINS;
    DDRH |= 1 << 3 | 1 << 4 | (AXES > 2 ? 1 << 5 : 0);
    PORTA |= 8;
    DDRA |= SIGN_PINS | ENABLE;
    PCMSK0 = ENCODER_PINS;
    PCICR = 1 << PCIE0;
#endif
    lines = ENCODERS;
}

static void begin_timers(void)
{
    PWM_TOP = BOARD_DUTY - 1; /* before the clock: a top of 0 is an event every cycle */
#if defined(__AVR_ATmega328P__)
    TCCR1A = 1 << WGM11;
    TCCR1B = 1 << WGM13 | 1 << WGM12 | 1 << CS10;
#else
    TCCR4A = 1 << WGM41;
    TCCR4B = 1 << WGM43 | 1 << WGM42 | 1 << CS40;
#endif
    OCR2A = TICK_STEPS - 1;
    TCCR2A = 1 << WGM21;
    TIMSK2 = 1 << OCIE2A;
    TCCR2B = 1 << CS22; /* 250 kHz */
}

static void begin_port(void)
{
    UBRR0 = 1;
    UCSR0A = 1 << U2X0;
    UCSR0C = 1 << UCSZ01 | 1 << UCSZ00;
    UCSR0B = 1 << RXCIE0 | 1 << RXEN0 | 1 << TXEN0;
}

static void take_byte(void)
{
    uint8_t answer[BOARD_FRAME];
    const uint8_t byte = rx[rx_out];
    rx_out = (uint8_t)(rx_out + 1) % RX_SIZE;
    const uint8_t size = board_take(&board, byte, answer);
    if (size > 0) {
        send(answer, size);
    }
}

int main(void)
{
    facts.reset_cause = reset_cause;
    board_begin(&board, &facts, 0);
    platform_motors_off(&board);
    begin_pins();
    begin_timers();
    begin_port();
    set_sleep_mode(SLEEP_MODE_IDLE);
    wdt_enable(WDTO_15MS);
    sei();
    for (;;) {
        while (rx_out != rx_in && ticked == 0) {
            take_byte();
        }
        if (ticked != 0) { /* a loop that hangs, or a tick that stands still, resets the chip */
            ticked = 0;
            wdt_reset();
        }
        cli();
        if (rx_out == rx_in && ticked == 0) {
            sleep_enable();
            sei(); /* the next instruction is done before any interrupt */
            sleep_cpu();
            sleep_disable();
        }
        sei();
    }
}
