// The line to the server: opens it, watches it, opens it again.

import { protocols, savedToken, tokenHeaders } from "./access";
import { waitMs } from "./backoff";
import type { FleetView, RouteLink, Selection } from "./view";

/** The server says something at least every 5 s. */
const SILENCE_MS = 12_000;

export type LineState =
  | { kind: "connecting" }
  | { kind: "open" }
  | { kind: "lost"; retryAtMs: number }
  | { kind: "refused" };

export interface Listener {
  onState(state: LineState): void;
  onView(view: FleetView): void;
  onRoute(route: GeoJSON.FeatureCollection): void;
}

class Refused extends Error {}

export class Connection {
  private socket: WebSocket | undefined;
  private retry: number | undefined;
  private watchdog: number | undefined;
  private failures = 0;
  private selected: string | null = null;
  private readonly routesSeen = new Set<string>();

  constructor(private readonly listener: Listener) {
    window.addEventListener("online", () => this.tryNow());
    document.addEventListener("visibilitychange", () => {
      if (!document.hidden) {
        this.tryNow();
      }
    });
  }

  /** Opens the line; from then on it keeps itself open. */
  async open(): Promise<void> {
    this.cancelRetry();
    this.listener.onState({ kind: "connecting" });
    try {
      await this.loadRoutes();
    } catch (error) {
      if (error instanceof Refused) {
        this.listener.onState({ kind: "refused" });
      } else {
        this.lose();
      }
      return;
    }
    this.listen();
  }

  /** Ends the wait before the next attempt, if it is waiting. */
  tryNow(): void {
    if (this.retry !== undefined) {
      void this.open();
    }
  }

  /** Tells the server which vehicle is shown; a line that is opened later tells it too. */
  select(vehicleId: string | null): void {
    if (vehicleId !== this.selected) {
      this.selected = vehicleId;
      this.tellSelected();
    }
  }

  private tellSelected(): void {
    if (this.socket?.readyState === WebSocket.OPEN) {
      const selection: Selection = { vehicle_id: this.selected };
      this.socket.send(JSON.stringify(selection));
    }
  }

  private listen(): void {
    const address = new URL("/v1/live", window.location.href);
    address.protocol = address.protocol.replace("http", "ws");
    const socket = new WebSocket(address, protocols(savedToken()));
    this.socket = socket;
    socket.onopen = () => {
      if (this.selected !== null) {
        this.tellSelected();
      }
    };
    socket.onmessage = (event: MessageEvent<string>) => {
      this.failures = 0;
      this.watch();
      const view = JSON.parse(event.data) as FleetView;
      if (view.kind === "snapshot") {
        this.listener.onState({ kind: "open" });
      }
      this.listener.onView(view);
    };
    socket.onclose = () => this.lose();
    this.watch();
  }

  private watch(): void {
    window.clearTimeout(this.watchdog);
    this.watchdog = window.setTimeout(() => this.lose(), SILENCE_MS);
  }

  private lose(): void {
    window.clearTimeout(this.watchdog);
    if (this.socket !== undefined) {
      // a line that fell silent may take minutes to close by itself
      this.socket.onopen = this.socket.onclose = this.socket.onmessage = null;
      this.socket.close();
      this.socket = undefined;
    }
    this.failures += 1;
    const wait = waitMs(this.failures, Math.random());
    this.retry = window.setTimeout(() => void this.open(), wait);
    this.listener.onState({ kind: "lost", retryAtMs: performance.now() + wait });
  }

  private cancelRetry(): void {
    window.clearTimeout(this.retry);
    this.retry = undefined;
  }

  private async loadRoutes(): Promise<void> {
    const { routes } = (await this.get("/v1/routes")) as { routes: RouteLink[] };
    const unseen = routes.filter((route) => !this.routesSeen.has(route.route_id));
    for (const route of unseen) {
      this.listener.onRoute((await this.get(route.href)) as GeoJSON.FeatureCollection);
      this.routesSeen.add(route.route_id);
    }
  }

  private async get(path: string): Promise<unknown> {
    const answer = await fetch(path, { headers: tokenHeaders(savedToken()) });
    if (answer.status === 401) {
      throw new Refused();
    }
    if (!answer.ok) {
      throw new Error(`${path}: ${answer.status}`);
    }
    return answer.json();
  }
}
