/* From the reset to main: floating-point unit, variables. */
#include <stdint.h>

#include "board.h"

extern uint32_t start_of_stack, load_of_data, start_of_data, end_of_data, start_of_bss, end_of_bss;

int main(void);
void reset(void);
void fault(void);

/* Coprocessor access control: both coprocessors of the floating-point unit (ARMv7-M, B3.2.20). */
#define CPACR (*(volatile uint32_t *)0xE000ED88u)

void reset(void)
{
    CPACR |= 0xFu << 20;
    __asm__ volatile("dsb\n isb" ::: "memory");
    uint32_t *from = &load_of_data;
    for (uint32_t *to = &start_of_data; to < &end_of_data; to++) {
        *to = *from;
        from++;
    }
    for (uint32_t *to = &start_of_bss; to < &end_of_bss; to++) {
        *to = 0;
    }
    board_exit(main() == 0);
}

void fault(void)
{
    board_line("fault");
    board_exit(false);
}

typedef void (*vector)(void);

struct vectors {
    uint32_t *stack;
    vector others[15];
};

__attribute__((section(".vectors"), used)) static const struct vectors vectors = {
    &start_of_stack,
    {reset, fault, fault, fault, fault, fault, 0, 0, 0, 0, fault, fault, 0, fault, fault},
};
