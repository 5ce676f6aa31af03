import { describe, expect, test } from "vitest";

import {
  accuracy,
  compassPoint,
  countdown,
  countdownRange,
  duration,
  heading,
  lateness,
  length,
  signed,
  speedKmh,
  travelled,
} from "../src/words";

describe("countdown", () => {
  test.each([
    [-30, "now"],
    [4, "now"],
    [38, "in 40 s"],
    [57, "in 55 s"],
    [58, "in 1 min"],
    [61, "in 1 min"],
    [170, "in 3 min"],
    [3600, "in 1 h"],
    [3900, "in 1 h 5 min"],
  ])("%d s is %s", (seconds, text) => expect(countdown(seconds)).toBe(text));
});

describe("what a countdown may be off by", () => {
  test.each([
    [200, 350, "(3–6)"],
    [181, 239, "(3–4)"],
    [50, 130, "(0–3)"],
    [18, 71, "(20–70 s)"],
    [-20, 12, "(0–10 s)"],
    [3500, 4000, "(58–67)"],
  ])("%d to %d s is %s", (early, late, text) => expect(countdownRange(early, late)).toBe(text));
});

describe("lateness", () => {
  test.each([
    [12, "on time"],
    [-29, "on time"],
    [95, "2 min late"],
    [-130, "2 min early"],
    [3900, "1 h 5 min late"],
  ])("%d s is %s", (seconds, text) => expect(lateness(seconds)).toBe(text));
});

describe("duration", () => {
  test.each([
    [0.2, "less than 1 s"],
    [12.4, "12 s"],
    [300, "5 min"],
    [7500, "2 h 5 min"],
    [300_000, "3 d"],
  ])("%d s is %s", (seconds, text) => expect(duration(seconds)).toBe(text));
});

test("unknown is a dash and never zero", () => {
  expect([length(null), signed(null, 1), speedKmh(undefined), heading(null)]).toEqual(
    Array(4).fill("–"),
  );
  expect(speedKmh(0)).toBe("0");
});

test("lengths turn to kilometres", () => {
  expect([length(820.4), length(1234), length(23_400)]).toEqual(["820 m", "1.2 km", "23 km"]);
  expect([accuracy(1.84), accuracy(25)]).toEqual(["1.8 m", "25 m"]);
});

test("a sign is shown, but a rounded zero has none", () => {
  expect([signed(1.26, 1), signed(-1.26, 1), signed(-0.04, 1)]).toEqual(["+1.3", "−1.3", "0.0"]);
});

test("reverse is negative", () => expect(speedKmh(-2)).toBe("−7"));

test("headings wrap at north", () => {
  expect([heading(359.7), compassPoint(359.7), compassPoint(46)]).toEqual(["0°", "N", "NE"]);
});

describe("a way and what it may be off by", () => {
  test.each([
    [12_345, 80, "12.3 ± 0.1 km"],
    [3_312, 14, "3.31 ± 0.01 km"],
    [820, 2, "0.820 ± 0.002 km"],
  ])("%d m and %d m are %s", (metres, std, text) => expect(travelled(metres, std)).toBe(text));
});
