// Pure: numbers and modes as people read them. Unknown is a dash, never 0.

import type { PoseMode } from "./view";

export const UNKNOWN = "–";
const MINUS = "−";

export const MODE_NAMES: Record<PoseMode, string> = {
  starting: "Starting",
  gps: "GPS only",
  fused: "Fused",
  dead_reckoning: "Dead reckoning",
  lost: "Lost",
};

export const MODE_MEANINGS: Record<PoseMode, string> = {
  starting: "position or heading not known yet",
  gps: "positions from the receiver, no wheel or gyro data",
  fused: "receiver, wheels and gyro together",
  dead_reckoning: "no accepted fix, carried on by wheels and gyro",
  lost: "position uncertain by more than 100 m",
};

/** "in 3 min", "in 40 s", "now"; a past arrival is "now" until the next prediction. */
export function countdown(seconds: number): string {
  if (seconds < 5) {
    return "now";
  }
  if (seconds < 57.5) {
    return `in ${Math.round(seconds / 5) * 5} s`;
  }
  const minutes = Math.round(seconds / 60);
  return minutes < 60 ? `in ${minutes} min` : `in ${hoursAndMinutes(minutes)}`;
}

/** "(3–6)" beside a countdown, in its minutes; "(20–70 s)" where the end is near. */
export function countdownRange(earlySeconds: number, lateSeconds: number): string {
  if (lateSeconds < 90) {
    const [early, late] = [earlySeconds, lateSeconds].map((seconds) =>
      Math.max(0, Math.round(seconds / 5) * 5),
    );
    return `(${early}–${late} s)`;
  }
  // the narrow way would promise more than is known
  const [early, late] = [Math.floor(earlySeconds / 60), Math.ceil(lateSeconds / 60)];
  return `(${Math.max(0, early)}–${late})`;
}

/** "on time", "4 min late", "2 min early": by the timetable. */
export function lateness(seconds: number): string {
  const minutes = Math.round(Math.abs(seconds) / 60);
  if (minutes < 1) {
    return "on time";
  }
  return `${minutes < 60 ? `${minutes} min` : hoursAndMinutes(minutes)} ${seconds > 0 ? "late" : "early"}`;
}

/** "12:05" by the reader's clock. */
export function clockTime(ms: number): string {
  return MINUTES.format(ms);
}

/** "less than 1 s", "12 s", "5 min", "2 h 5 min", "3 d". */
export function duration(seconds: number): string {
  if (seconds < 1) {
    return "less than 1 s";
  }
  if (seconds < 90) {
    return `${Math.round(seconds)} s`;
  }
  const minutes = Math.round(seconds / 60);
  return minutes < 90 ? `${minutes} min` : hoursAndMinutes(minutes);
}

/** "since 14:05 (5 min)", from a day on with the date. */
export function since(fromMs: number, nowMs: number): string {
  const seconds = Math.max(0, (nowMs - fromMs) / 1000);
  const at = seconds < 86_400 ? MINUTES.format(fromMs) : dateAndTime(fromMs);
  return `since ${at} (${duration(seconds)})`;
}

/** "12/s", "0.3/s". */
export function rate(hz: number): string {
  return `${hz.toFixed(hz < 10 ? 1 : 0)}/s`;
}

function hoursAndMinutes(minutes: number): string {
  const hours = Math.floor(minutes / 60);
  if (hours >= 48) {
    return `${Math.floor(hours / 24)} d`;
  }
  return minutes % 60 === 0 ? `${hours} h` : `${hours} h ${minutes % 60} min`;
}

const MINUTES = new Intl.DateTimeFormat([], { hour: "numeric", minute: "2-digit" });
const SECONDS = new Intl.DateTimeFormat([], { timeStyle: "medium" });
/** A span under three minutes would read as one and the same minute. */
const COARSE_MS = 180_000;

/** "14:04 – 14:09" in the reader's own time zone, with seconds where minutes are too coarse. */
export function clockRange(fromMs: number, toMs: number): string {
  return (toMs - fromMs < COARSE_MS ? SECONDS : MINUTES).formatRange(fromMs, toMs);
}

export function dateAndTime(ms: number): string {
  return new Date(ms).toLocaleString([], { dateStyle: "medium", timeStyle: "medium" });
}

/** "820 m", "1.2 km". */
export function length(metres: number | null | undefined): string {
  if (metres == null) {
    return UNKNOWN;
  }
  if (metres < 1000) {
    return `${Math.round(metres)} m`;
  }
  return `${(metres / 1000).toFixed(metres < 10_000 ? 1 : 0)} km`;
}

/** "12.3 ± 0.1 km": a way and one sigma of it, with as many digits as that has. */
export function travelled(metres: number, stdMetres: number): string {
  const std = stdMetres / 1000;
  const decimals = std >= 0.05 ? 1 : std >= 0.005 ? 2 : 3;
  return `${(metres / 1000).toFixed(decimals)} ± ${std.toFixed(decimals)} km`;
}

/** "1.8 m", "25 m": an accuracy keeps a decimal while it matters. */
export function accuracy(metres: number): string {
  return metres < 9.95 ? `${metres.toFixed(1)} m` : length(metres);
}

export function signed(value: number | null | undefined, decimals: number): string {
  if (value == null) {
    return UNKNOWN;
  }
  const text = Math.abs(value).toFixed(decimals);
  if (Number(text) === 0) {
    return text;
  }
  return `${value < 0 ? MINUS : "+"}${text}`;
}

export function speedKmh(mps: number | null | undefined): string {
  if (mps == null) {
    return UNKNOWN;
  }
  const kmh = Math.round(Math.abs(mps) * 3.6);
  return mps < 0 && kmh > 0 ? `${MINUS}${kmh}` : `${kmh}`;
}

const POINTS = ["N", "NE", "E", "SE", "S", "SW", "W", "NW"] as const;

/** "87°". */
export function heading(degrees: number | null | undefined): string {
  return degrees == null ? UNKNOWN : `${Math.round(degrees) % 360}°`;
}

/** The nearest of eight compass points. */
export function compassPoint(degrees: number | null | undefined): string {
  return degrees == null ? "" : (POINTS[Math.round(degrees / 45) % 8] ?? "");
}
