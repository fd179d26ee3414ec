// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0

/// Vectors are plain arrays, sizes at most six: nothing here is worth a library.

export type Vector = number[];

export function dot(a: readonly number[], b: readonly number[]): number {
  let sum = 0;
  for (let i = 0; i < a.length; ++i) sum += a[i]! * b[i]!;
  return sum;
}

/// Sum of `coefficients[k] * vectors[k]`.
export function combine(vectors: readonly Vector[], coefficients: readonly number[]): Vector {
  const out = new Array<number>(vectors[0]?.length ?? 0).fill(0);
  vectors.forEach((v, k) => v.forEach((x, i) => (out[i]! += coefficients[k]! * x)));
  return out;
}

/// Gram-Schmidt; vectors that add no new direction are left out. Directions already in `basis` count
/// as taken.
export function orthonormalise(
  vectors: readonly Vector[],
  basis: readonly Vector[] = [],
): Vector[] {
  const out: Vector[] = [];
  for (const vector of vectors) {
    let v = [...vector];
    // Twice is enough (Kahan): the second pass removes what rounding left.
    for (let pass = 0; pass < 2; ++pass) {
      for (const b of [...basis, ...out]) v = combine([v, b], [1, -dot(v, b)]);
    }
    const norm = Math.sqrt(dot(v, v));
    if (norm > 1e-6) out.push(v.map((x) => x / norm));
  }
  return out;
}

/// Coefficients of `v` in linearly independent unit vectors that span it (normal equations, solved by
/// elimination; they are well-conditioned at the sizes and angles that occur here).
export function coefficients(v: Vector, basis: readonly Vector[]): number[] {
  const n = basis.length;
  const rows = basis.map((a) => [...basis.map((b) => dot(a, b)), dot(a, v)]);
  for (let p = 0; p < n; ++p) {
    const pivot = rows[p]!;
    for (let r = 0; r < n; ++r) {
      if (r === p) continue;
      const factor = rows[r]![p]! / (pivot[p]! || 1);
      rows[r] = rows[r]!.map((x, i) => x - factor * pivot[i]!);
    }
  }
  return rows.map((row, p) => row[n]! / (row[p]! || 1));
}

/// Eigenvalues, rising, and eigenvectors of a symmetric matrix by Jacobi rotations (Golub, Van Loan,
/// Matrix Computations, section 8.5).
export function eigenSymmetric(matrix: readonly Vector[]): { values: number[]; vectors: Vector[] } {
  const n = matrix.length;
  const a = matrix.map((row) => [...row]);
  const v = a.map((_, i) => a.map((_, j) => (i === j ? 1 : 0)));
  for (let sweep = 0; sweep < 30; ++sweep) {
    let off = 0;
    for (let p = 0; p < n; ++p) for (let q = p + 1; q < n; ++q) off += a[p]![q]! ** 2;
    if (off < 1e-24) break;
    for (let p = 0; p < n; ++p) for (let q = p + 1; q < n; ++q) rotate(a, v, p, q);
  }
  const order = a.map((_, i) => i).sort((i, j) => a[i]![i]! - a[j]![j]!);
  return {
    values: order.map((i) => a[i]![i]!),
    vectors: order.map((i) => v.map((row) => row[i]!)),
  };
}

function rotate(a: number[][], v: number[][], p: number, q: number): void {
  const apq = a[p]![q]!;
  if (Math.abs(apq) < 1e-15) return;
  const theta = (a[q]![q]! - a[p]![p]!) / (2 * apq);
  const t = (theta < 0 ? -1 : 1) / (Math.abs(theta) + Math.sqrt(theta * theta + 1));
  const c = 1 / Math.sqrt(t * t + 1);
  const s = t * c;
  for (const row of [...a, ...v]) {
    const [x, y] = [row[p]!, row[q]!];
    row[p] = c * x - s * y;
    row[q] = s * x + c * y;
  }
  const [row_p, row_q] = [[...a[p]!], [...a[q]!]];
  a[p] = row_p.map((x, i) => c * x - s * row_q[i]!);
  a[q] = row_p.map((x, i) => s * x + c * row_q[i]!);
}
