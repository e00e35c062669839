"""The page about a run: what it recorded, drawn and tabulated in one HTML file that needs no network."""
