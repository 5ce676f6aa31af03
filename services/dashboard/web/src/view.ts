// What the server tells of the fleet; mirrors wayline_dashboard/view.py. Times are RFC 3339 UTC.

export type PoseMode = "starting" | "gps" | "fused" | "dead_reckoning" | "lost";

/** One sigma along its axes; the major one points orientation_deg clockwise from north. */
export interface Ellipse {
  semi_major_m: number;
  semi_minor_m: number;
  orientation_deg: number;
}

export interface Pose {
  t: string;
  mode: PoseMode;
  lat_deg: number | null;
  lon_deg: number | null;
  alt_m: number | null;
  alt_std_m: number | null;
  heading_deg: number | null;
  heading_std_deg: number | null;
  speed_mps: number | null;
  speed_std_mps: number | null;
  grade_pct: number | null;
  grade_std_pct: number | null;
  distance_m: number;
  ellipse: Ellipse | null;
}

export interface Fix {
  t: string;
  source: string;
  valid: boolean;
  fix: string;
  lat_deg: number | null;
  lon_deg: number | null;
  satellites: number | null;
  hdop: number | null;
  h_std_m: number | null;
}

export interface SensorSlope {
  sensor: string;
  source: string | null;
  slope_pct: number;
  slope_std_pct: number;
  refused: boolean;
}

export interface Status {
  t: string;
  calibration: "none" | "started" | "calibrated";
  outage_s: number;
  late: number;
  rejected: number;
  last_rejection: string | null;
  slopes: SensorSlope[];
}

export interface Progress {
  t: string;
  route_id: string;
  trip_id: string | null;
  distance_m: number;
  distance_std_m: number;
  lap: number;
  cross_track_m: number;
  on_route: boolean;
  delay_s: number | null;
}

export interface Stop {
  stop_id: string;
  name: string;
  distance_m: number;
  arrival: string;
  early: string;
  late: string;
  scheduled: string | null;
  delay_s: number | null;
  trip_id: string | null;
}

export interface Arrivals {
  t: string;
  route_id: string;
  trip_id: string | null;
  headsign: string | null;
  stale: boolean;
  stops: Stop[];
}

export interface SlopePoint {
  distance_m: number;
  grade_pct: number | null;
  grade_std_pct: number | null;
  alt_m: number | null;
  runs: number;
}

export interface Horizon {
  t: string;
  road_id: string | null;
  points: SlopePoint[];
}

/** What a service lacks. */
export interface Missing {
  /** "router", "input", "database", or a source's name. */
  subject: string;
  what: string;
  since: string;
}

export interface Service {
  service: string;
  up: boolean;
  t: string | null;
  version: string | null;
  in_rate_hz: number | null;
  out_rate_hz: number | null;
  backlog: number;
  dropped: number;
  dropped_rate_hz: number;
  bad_input: number;
  bad_input_rate_hz: number;
  lag_ms_p50: number | null;
  lag_ms_p99: number | null;
  detail: string | null;
  missing: Missing[];
  recorded: boolean;
}

export interface TrailPoint {
  lat_deg: number;
  lon_deg: number;
  mode: PoseMode;
}

/** Sections left out are unchanged; trail follows the trail already told unless it restarts. */
export interface VehicleChange {
  vehicle_id: string;
  heard?: string;
  pose?: Pose;
  fix?: Fix;
  status?: Status;
  progress?: Progress;
  arrivals?: Arrivals;
  horizon?: Horizon;
  services?: Service[];
  trail?: TrailPoint[];
  trail_restart?: boolean;
  /** With a restart: when the vehicle was at its first point. */
  trail_began?: string;
}

export interface FleetView {
  kind: "snapshot" | "changes";
  now: string;
  /** The vehicle that is told whole; the others are told only where they are. */
  selected: string | null;
  vehicles: VehicleChange[];
  /** Dropped before vehicles are taken: they were silent for long. */
  gone: string[];
  services: Service[] | null;
}

/** What the page sends: the vehicle that it shows. */
export interface Selection {
  vehicle_id: string | null;
}

export interface RouteLink {
  route_id: string;
  name: string;
  href: string;
}
