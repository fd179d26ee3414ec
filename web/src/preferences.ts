// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0

/// What the user chose, kept over reloads. `?name=value` in the address wins over what was kept, and
/// is not itself kept.
const kPrefix = "sgs.";
const query = new URLSearchParams(location.search);

export function preference<T extends string>(name: string, allowed: readonly T[]): T | null {
  for (const value of [query.get(name), stored(name)]) {
    if (value !== null && (allowed as readonly string[]).includes(value)) return value as T;
  }
  return null;
}

export function remember(name: string, value: string): void {
  query.delete(name);
  try {
    localStorage.setItem(kPrefix + name, value);
  } catch {
    // Storage may be switched off; the choice then lasts as long as the page.
  }
}

function stored(name: string): string | null {
  try {
    return localStorage.getItem(kPrefix + name);
  } catch {
    return null;
  }
}
