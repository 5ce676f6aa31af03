// The map's colours, light and dark; the page's own are in page.css.

export interface MapTheme {
  background: string;
  grid: string;
  gridText: string;
  route: string;
  routeCasing: string;
  stop: string;
  text: string;
  halo: string;
  trail: string;
  reckoned: string;
  fix: string;
  vehicle: string;
  other: string;
}

export const LIGHT: MapTheme = {
  background: "#f4f3ef",
  grid: "#e3e1da",
  gridText: "#8b8980",
  route: "#ffffff",
  routeCasing: "#c4c9c6",
  stop: "#30403d",
  text: "#22302d",
  halo: "#f4f3ef",
  trail: "#0b7f72",
  reckoned: "#b86500",
  fix: "#c2308a",
  vehicle: "#075a51",
  other: "#5f6e6b",
};

export const DARK: MapTheme = {
  background: "#14191a",
  grid: "#293334",
  gridText: "#73807e",
  route: "#36423f",
  routeCasing: "#4d5b58",
  stop: "#d6e0dd",
  text: "#d6e0dd",
  halo: "#14191a",
  trail: "#2cb6a4",
  reckoned: "#f0a33c",
  fix: "#f06ac0",
  vehicle: "#57dccb",
  other: "#8b9b98",
};
