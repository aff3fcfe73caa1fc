#include "hash.h"

#include <string.h>

#include "board.h"

struct hash hash_new(void)
{
    const struct hash hash = {0xCBF29CE484222325u};
    return hash;
}

void hash_bits(struct hash *hash, uint32_t bits)
{
    for (unsigned shift = 0; shift < 32; shift += 8) {
        hash->value = (hash->value ^ ((bits >> shift) & 0xFFu)) * 0x100000001B3u;
    }
}

void hash_number(struct hash *hash, float number)
{
    uint32_t bits;
    memcpy(&bits, &number, sizeof bits);
    hash_bits(hash, bits);
}

void hash_numbers(struct hash *hash, const float *numbers, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        hash_number(hash, numbers[i]);
    }
}

void hash_line(const char *name, const struct hash *hash)
{
    char line[64];
    size_t n = 0;
    while (name[n] != '\0' && n < sizeof line - 18u) {
        line[n] = name[n];
        n++;
    }
    line[n] = ' ';
    n++;
    for (unsigned shift = 64; shift > 0;) {
        shift -= 4;
        line[n] = "0123456789abcdef"[(hash->value >> shift) & 0xFu];
        n++;
    }
    line[n] = '\0';
    board_line(line);
}
