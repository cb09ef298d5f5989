<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="de" sourcelanguage="en">
 <context>
  <name>LceMold</name>
  <message>
   <source>Opens a new document with one of the shipped examples, ready to be designed</source>
   <translation>Öffnet ein neues Dokument mit einem der mitgelieferten Beispiele, bereit zum Entwurf</translation>
  </message>
  <message>
   <source>Examples</source>
   <translation>Beispiele</translation>
  </message>
  <message>
   <source>Opens this example</source>
   <translation>Öffnet dieses Beispiel</translation>
  </message>
  <message>
   <source>Meshes</source>
   <translation>Netze</translation>
  </message>
  <message>
   <source>Choose a file</source>
   <translation>Datei wählen</translation>
  </message>
  <message>
   <source>(none)</source>
   <translation>(keine)</translation>
  </message>
  <message>
   <source>Finding</source>
   <translation>Befund</translation>
  </message>
  <message>
   <source>Check</source>
   <translation>Prüfung</translation>
  </message>
  <message>
   <source>Value</source>
   <translation>Wert</translation>
  </message>
  <message>
   <source>Limit</source>
   <translation>Grenze</translation>
  </message>
  <message>
   <source>Place</source>
   <translation>Ort</translation>
  </message>
  <message>
   <source>What was measured</source>
   <translation>Was gemessen wurde</translation>
  </message>
  <message>
   <source>Double-click a finding to see its place</source>
   <translation>Doppelklick auf einen Befund zeigt seinen Ort</translation>
  </message>
  <message>
   <source>Design review</source>
   <translation>Entwurfsprüfung</translation>
  </message>
  <message>
   <source>stale: parameters changed</source>
   <translation>veraltet: Parameter geändert</translation>
  </message>
  <message>
   <source>channels</source>
   <translation>Kanäle</translation>
  </message>
  <message>
   <source>Cell</source>
   <translation>Zelle</translation>
  </message>
  <message>
   <source>Shows the cell itself, whole and closed</source>
   <translation>Zeigt die Zelle selbst, ganz und geschlossen</translation>
  </message>
  <message>
   <source>Target and Flat Sheet</source>
   <translation>Ziel und flacher Film</translation>
  </message>
  <message>
   <source>Shows the flat sheet and the target beside it, in the colour of the director</source>
   <translation>Zeigt den flachen Film und daneben das Ziel in der Farbe des Direktors</translation>
  </message>
  <message>
   <source>Directors</source>
   <translation>Direktoren</translation>
  </message>
  <message>
   <source>Shows the director of every triangle in the colour of its twist</source>
   <translation>Zeigt den Direktor jedes Dreiecks in der Farbe seiner Verdrillung</translation>
  </message>
  <message>
   <source>Predicted Shape</source>
   <translation>Vorhergesagte Form</translation>
  </message>
  <message>
   <source>Shows the heated sheet in the colour of its distance from the target</source>
   <translation>Zeigt den erwärmten Film in der Farbe seines Abstands vom Ziel</translation>
  </message>
  <message>
   <source>Channels of the Bottom Plate</source>
   <translation>Kanäle der unteren Platte</translation>
  </message>
  <message>
   <source>Shows all channels of the bottom plate as lines, seen from above</source>
   <translation>Zeigt alle Kanäle der unteren Platte als Linien, von oben gesehen</translation>
  </message>
  <message>
   <source>Channels of the Top Plate</source>
   <translation>Kanäle der oberen Platte</translation>
  </message>
  <message>
   <source>Shows all channels of the top plate as lines, seen from above</source>
   <translation>Zeigt alle Kanäle der oberen Platte als Linien, von oben gesehen</translation>
  </message>
  <message>
   <source>Exploded Cell</source>
   <translation>Zelle auseinandergezogen</translation>
  </message>
  <message>
   <source>Takes the cell apart in the view, or puts it together</source>
   <translation>Zieht die Zelle in der Ansicht auseinander oder setzt sie zusammen</translation>
  </message>
  <message>
   <source>Section through the Gap</source>
   <translation>Schnitt durch den Spalt</translation>
  </message>
  <message>
   <source>Cuts the cell open through the channel window in the view, or closes it</source>
   <translation>Schneidet die Zelle in der Ansicht durch das Kanalfenster auf oder schließt sie</translation>
  </message>
  <message>
   <source>Domain Table</source>
   <translation>Tabelle der Domänen</translation>
  </message>
  <message>
   <source>Lists all domains; clicks in the view select their rows, and rows mark them in the view</source>
   <translation>Listet alle Domänen auf; Klicks in der Ansicht wählen Zeilen, gewählte Zeilen sind in der Ansicht markiert</translation>
  </message>
  <message>
   <source>More</source>
   <translation>Mehr</translation>
  </message>
  <message>
   <source>Stop</source>
   <translation>Anhalten</translation>
  </message>
  <message>
   <source>starting</source>
   <translation>beginnt</translation>
  </message>
  <message>
   <source>Preset</source>
   <translation>Vorgabe</translation>
  </message>
  <message>
   <source>Folder</source>
   <translation>Ordner</translation>
  </message>
  <message>
   <source>(as below)</source>
   <translation>(wie unten)</translation>
  </message>
  <message>
   <source>choose a folder for the files</source>
   <translation>Ordner für die Dateien wählen</translation>
  </message>
  <message>
   <source>stopping</source>
   <translation>wird angehalten</translation>
  </message>
  <message>
   <source>energy</source>
   <translation>Energie</translation>
  </message>
  <message>
   <source>Target</source>
   <translation>Ziel</translation>
  </message>
  <message>
   <source>New Cell…</source>
   <translation>Neue Zelle …</translation>
  </message>
  <message>
   <source>Starts a cell: the surface to make, the material, the size of the sheet</source>
   <translation>Beginnt eine Zelle: die gewünschte Fläche, das Material, die Größe des Films</translation>
  </message>
  <message>
   <source>New cell</source>
   <translation>Neue Zelle</translation>
  </message>
  <message>
   <source>Design…</source>
   <translation>Entwurf …</translation>
  </message>
  <message>
   <source>Solves the flat sheet, its director and its twist for the target</source>
   <translation>Berechnet den flachen Film, seinen Direktor und dessen Verdrillung für das Ziel</translation>
  </message>
  <message>
   <source>Design</source>
   <translation>Entwurf</translation>
  </message>
  <message>
   <source>Predict…</source>
   <translation>Vorhersage …</translation>
  </message>
  <message>
   <source>Simulates the heating of the sheet and compares it with the target</source>
   <translation>Simuliert das Erwärmen des Films und vergleicht das Ergebnis mit dem Ziel</translation>
  </message>
  <message>
   <source>Predict</source>
   <translation>Vorhersage</translation>
  </message>
  <message>
   <source>Plates and Spacer…</source>
   <translation>Platten und Abstandshalter …</translation>
  </message>
  <message>
   <source>Adds the two plates, the spacer and the film around the sheet</source>
   <translation>Fügt die zwei Platten, den Abstandshalter und den Film hinzu</translation>
  </message>
  <message>
   <source>Plates and spacer</source>
   <translation>Platten und Abstandshalter</translation>
  </message>
  <message>
   <source>Channel Window…</source>
   <translation>Kanalausschnitt …</translation>
  </message>
  <message>
   <source>Shows the channels of the domains you name as solids</source>
   <translation>Zeigt die Kanäle der genannten Domänen als Körper</translation>
  </message>
  <message>
   <source>Channel window</source>
   <translation>Kanalausschnitt</translation>
  </message>
  <message>
   <source>Mask…</source>
   <translation>Maske …</translation>
  </message>
  <message>
   <source>Writes the masks of both plates for the laser writer</source>
   <translation>Schreibt die Masken beider Platten für den Laserschreiber</translation>
  </message>
  <message>
   <source>Mask</source>
   <translation>Maske</translation>
  </message>
  <message>
   <source>Drawings</source>
   <translation>Zeichnungen</translation>
  </message>
  <message>
   <source>Adds the fabrication drawings of the cell to the document</source>
   <translation>Fügt dem Dokument die Fertigungszeichnungen der Zelle hinzu</translation>
  </message>
  <message>
   <source>Design Review</source>
   <translation>Entwurfsprüfung</translation>
  </message>
  <message>
   <source>Checks the cell, lists its parts and masses, and shows what was found</source>
   <translation>Prüft die Zelle, listet Teile und Massen auf und zeigt die Befunde</translation>
  </message>
  <message>
   <source>Review…</source>
   <translation>Prüfung …</translation>
  </message>
  <message>
   <source>Writes all files, reads them back and lists what was found</source>
   <translation>Schreibt alle Dateien, liest sie zurück und listet die Befunde auf</translation>
  </message>
  <message>
   <source>Review</source>
   <translation>Prüfung</translation>
  </message>
  <message>
   <source>Export…</source>
   <translation>Export …</translation>
  </message>
  <message>
   <source>Writes everything: table, masks, CAD files and report, as ./lce build does</source>
   <translation>Schreibt alles: Tabelle, Masken, CAD-Dateien und Bericht, wie ./lce build</translation>
  </message>
  <message>
   <source>Export</source>
   <translation>Export</translation>
  </message>
  <message>
   <source>Domain</source>
   <translation>Domäne</translation>
  </message>
  <message>
   <source>x [mm]</source>
   <translation>x [mm]</translation>
  </message>
  <message>
   <source>y [mm]</source>
   <translation>y [mm]</translation>
  </message>
  <message>
   <source>Area [mm²]</source>
   <translation>Fläche [mm²]</translation>
  </message>
  <message>
   <source>θ [°]</source>
   <translation>θ [°]</translation>
  </message>
  <message>
   <source>Δθ [°]</source>
   <translation>Δθ [°]</translation>
  </message>
  <message>
   <source>θ top [°]</source>
   <translation>θ oben [°]</translation>
  </message>
  <message>
   <source>θ bottom [°]</source>
   <translation>θ unten [°]</translation>
  </message>
  <message>
   <source>Stretch along</source>
   <translation>Streckung längs</translation>
  </message>
  <message>
   <source>Stretch across</source>
   <translation>Streckung quer</translation>
  </message>
  <message>
   <source>Channels top</source>
   <translation>Kanäle oben</translation>
  </message>
  <message>
   <source>Channels bottom</source>
   <translation>Kanäle unten</translation>
  </message>
  <message>
   <source>Domains</source>
   <translation>Domänen</translation>
  </message>
  <message>
   <source>Channels of the Selection as Solids</source>
   <translation>Kanäle der Auswahl als Körper</translation>
  </message>
  <message>
   <source>Shows the real channels of the selected domains in the cell</source>
   <translation>Zeigt die wirklichen Kanäle der gewählten Domänen in der Zelle</translation>
  </message>
  <message>
   <source>Close the panel first</source>
   <translation>Zuerst das Eingabefeld schließen</translation>
  </message>
  <message>
   <source>Channels, bottom plate</source>
   <translation>Kanäle, untere Platte</translation>
  </message>
  <message>
   <source>Channels, top plate</source>
   <translation>Kanäle, obere Platte</translation>
  </message>
  <message>
   <source>director θ</source>
   <translation>Direktor θ</translation>
  </message>
  <message>
   <source>Target and flat sheet</source>
   <translation>Ziel und flacher Film</translation>
  </message>
  <message>
   <source>twist Δθ</source>
   <translation>Verdrillung Δθ</translation>
  </message>
  <message>
   <source>distance from the target</source>
   <translation>Abstand vom Ziel</translation>
  </message>
  <message>
   <source>Predicted shape</source>
   <translation>Vorhergesagte Form</translation>
  </message>
  <message>
   <source>channel direction</source>
   <translation>Kanalrichtung</translation>
  </message>
  <message>
   <source>Face</source>
   <translation>Gesicht</translation>
  </message>
  <message>
   <source>Dome</source>
   <translation>Kuppel</translation>
  </message>
  <message>
   <source>Saddle</source>
   <translation>Sattel</translation>
  </message>
  <message>
   <source>Leaf</source>
   <translation>Blatt</translation>
  </message>
  <message>
   <source>Material</source>
   <translation>Material</translation>
  </message>
  <message>
   <source>Sheet</source>
   <translation>Film</translation>
  </message>
  <message>
   <source>Channels</source>
   <translation>Kanäle</translation>
  </message>
  <message>
   <source>Plates</source>
   <translation>Platten</translation>
  </message>
  <message>
   <source>Marks</source>
   <translation>Marken</translation>
  </message>
  <message>
   <source>Spacer</source>
   <translation>Abstandshalter</translation>
  </message>
  <message>
   <source>Solver</source>
   <translation>Löser</translation>
  </message>
  <message>
   <source>Prediction</source>
   <translation>Vorhersage</translation>
  </message>
  <message>
   <source>Output</source>
   <translation>Ausgabe</translation>
  </message>
  <message>
   <source>Target mesh</source>
   <translation>Zielnetz</translation>
  </message>
  <message>
   <source>mesh file: STL, OBJ, PLY or OFF, relative to the job file</source>
   <translation>Netzdatei: STL, OBJ, PLY oder OFF, relativ zur Auftragsdatei</translation>
  </message>
  <message>
   <source>Target surface</source>
   <translation>Zielfläche</translation>
  </message>
  <message>
   <source>a shipped surface instead of a mesh: dome, saddle, leaf, cone, sphere-zone, face</source>
   <translation>eine mitgelieferte Fläche statt eines Netzes: dome, saddle, leaf, cone, sphere-zone, face</translation>
  </message>
  <message>
   <source>Target subdivision</source>
   <translation>Unterteilung des Ziels</translation>
  </message>
  <message>
   <source>how a mesh coarser than the domains is refined: loop for smooth surfaces, midpoint for faceted ones</source>
   <translation>wie ein Netz verfeinert wird, das gröber als die Domänen ist: loop für glatte, midpoint für facettierte Flächen</translation>
  </message>
  <message>
   <source>Target remesh</source>
   <translation>Ziel neu vernetzen</translation>
  </message>
  <message>
   <source>mesh the target anew, with even triangles of the domains' size; false keeps the triangles of the input</source>
   <translation>das Ziel neu vernetzen, mit gleichmäßigen Dreiecken von der Größe der Domänen; nein behält die Dreiecke der Eingabe</translation>
  </message>
  <message>
   <source>Target cuts</source>
   <translation>Ziel aufschneiden</translation>
  </message>
  <message>
   <source>cut the target open where it is closed, has handles or is too curved; the sheet then has seams</source>
   <translation>das Ziel aufschneiden, wo es geschlossen ist, Henkel hat oder zu stark gekrümmt ist; das Blatt bekommt dann Nähte</translation>
  </message>
  <message>
   <source>Target flip</source>
   <translation>Ziel wenden</translation>
  </message>
  <message>
   <source>turn the surface over, so that its other side becomes the top of the sheet</source>
   <translation>die Fläche wenden, sodass ihre andere Seite die Oberseite des Films wird</translation>
  </message>
  <message>
   <source>Material preset</source>
   <translation>Materialvorgabe</translation>
  </message>
  <message>
   <source>name of a preset in resources/materials.toml (rm82-pdt-1to1 when nothing is given)</source>
   <translation>Name einer Vorgabe in resources/materials.toml (rm82-pdt-1to1, wenn nichts angegeben ist)</translation>
  </message>
  <message>
   <source>Material lambda</source>
   <translation>Material Lambda</translation>
  </message>
  <message>
   <source>stretch along the director at the target temperature</source>
   <translation>Streckung längs des Direktors bei der Zieltemperatur</translation>
  </message>
  <message>
   <source>Material nu</source>
   <translation>Material Nu</translation>
  </message>
  <message>
   <source>stretch across the director is lambda^-nu; 0.5 conserves volume</source>
   <translation>die Streckung quer zum Direktor ist Lambda^-Nu; 0,5 erhält das Volumen</translation>
  </message>
  <message>
   <source>Material curve</source>
   <translation>Materialkurve</translation>
  </message>
  <message>
   <source>CSV file T_C, lambda_parallel, lambda_perpendicular, relative to the job file</source>
   <translation>CSV-Datei T_C, lambda_parallel, lambda_perpendicular, relativ zur Auftragsdatei</translation>
  </message>
  <message>
   <source>Material temperature</source>
   <translation>Materialtemperatur</translation>
  </message>
  <message>
   <source>temperature at which the curve is read</source>
   <translation>Temperatur, bei der die Kurve abgelesen wird</translation>
  </message>
  <message>
   <source>Sheet width</source>
   <translation>Filmbreite</translation>
  </message>
  <message>
   <source>longest side of the flat sheet</source>
   <translation>längste Seite des flachen Films</translation>
  </message>
  <message>
   <source>Sheet gap</source>
   <translation>Spalt</translation>
  </message>
  <message>
   <source>film thickness = spacer thickness</source>
   <translation>Filmdicke = Dicke des Abstandshalters</translation>
  </message>
  <message>
   <source>Sheet twist gain</source>
   <translation>Verdrillungsfaktor</translation>
  </message>
  <message>
   <source>multiplies the twist; 2 reproduces the paper's S5 as printed</source>
   <translation>vervielfacht die Verdrillung; 2 ergibt S5, wie es in der Arbeit gedruckt ist</translation>
  </message>
  <message>
   <source>Sheet twist limit</source>
   <translation>Verdrillungsgrenze</translation>
  </message>
  <message>
   <source>largest twist through the thickness; what is beyond is cut off</source>
   <translation>größte Verdrillung durch die Dicke; was darüber liegt, wird abgeschnitten</translation>
  </message>
  <message>
   <source>Sheet edge overdrive</source>
   <translation>Randverstärkung</translation>
  </message>
  <message>
   <source>multiply the twist by 1 + 5 exp(-d / 2 mm), d = distance to the edge</source>
   <translation>die Verdrillung mit 1 + 5 exp(-d / 2 mm) multiplizieren, d = Abstand zum Rand</translation>
  </message>
  <message>
   <source>Domain kind</source>
   <translation>Domänenart</translation>
  </message>
  <message>
   <source>shape of the domains: the design's triangles, hexagons, or the cells of a centroidal Voronoi tessellation</source>
   <translation>Form der Domänen: die Dreiecke des Entwurfs, Sechsecke oder die Zellen einer zentrierten Voronoi-Zerlegung</translation>
  </message>
  <message>
   <source>Domain size</source>
   <translation>Domänengröße</translation>
  </message>
  <message>
   <source>mean edge of a triangle, or between the centres of neighbours</source>
   <translation>mittlere Kante eines Dreiecks oder Abstand der Mitten von Nachbarn</translation>
  </message>
  <message>
   <source>Channel width</source>
   <translation>Kanalbreite</translation>
  </message>
  <message>
   <source>channel width</source>
   <translation>Breite eines Kanals</translation>
  </message>
  <message>
   <source>Channel spacing</source>
   <translation>Kanalabstand</translation>
  </message>
  <message>
   <source>land between two channels</source>
   <translation>Steg zwischen zwei Kanälen</translation>
  </message>
  <message>
   <source>Channel depth</source>
   <translation>Kanaltiefe</translation>
  </message>
  <message>
   <source>channel depth</source>
   <translation>Tiefe eines Kanals</translation>
  </message>
  <message>
   <source>Channel guard</source>
   <translation>Kanalrand</translation>
  </message>
  <message>
   <source>channels end this far inside their domain, so that neighbours stay two guards apart</source>
   <translation>so weit vor dem Rand ihrer Domäne enden Kanäle, sodass Nachbarn zwei Ränder Abstand halten</translation>
  </message>
  <message>
   <source>Channel align phase</source>
   <translation>Kanalphasen angleichen</translation>
  </message>
  <message>
   <source>shift each domain's channels so that they meet a neighbour's, where the directions differ by under 5 deg</source>
   <translation>die Kanäle jeder Domäne so verschieben, dass sie die des Nachbarn treffen, wo sich die Richtungen um weniger als 5 Grad unterscheiden</translation>
  </message>
  <message>
   <source>Plate carrier</source>
   <translation>Trägerglas</translation>
  </message>
  <message>
   <source>standard glass, width x height in mm; auto: the smallest that fits, or width_mm and height_mm</source>
   <translation>Standardglas, Breite x Höhe in mm; auto: das kleinste passende, oder width_mm und height_mm</translation>
  </message>
  <message>
   <source>Plate width</source>
   <translation>Plattenbreite</translation>
  </message>
  <message>
   <source>glass width (x); default: smallest standard glass</source>
   <translation>Breite des Glases (x); Standard: kleinstes Standardglas</translation>
  </message>
  <message>
   <source>Plate height</source>
   <translation>Plattenhöhe</translation>
  </message>
  <message>
   <source>glass height (y)</source>
   <translation>Höhe des Glases (y)</translation>
  </message>
  <message>
   <source>Plate glass</source>
   <translation>Glasdicke</translation>
  </message>
  <message>
   <source>glass thickness</source>
   <translation>Dicke des Glases</translation>
  </message>
  <message>
   <source>Plate replications</source>
   <translation>Abformungen</translation>
  </message>
  <message>
   <source>casts from master to plate: PDMS, epoxy; an odd number turns handedness and relief</source>
   <translation>Abgüsse vom Master bis zur Platte: PDMS, Epoxid; eine ungerade Zahl kehrt Händigkeit und Relief um</translation>
  </message>
  <message>
   <source>Plate epoxy</source>
   <translation>Epoxidschicht</translation>
  </message>
  <message>
   <source>epoxy layer under the channels</source>
   <translation>Epoxidschicht unter den Kanälen</translation>
  </message>
  <message>
   <source>Plate chamfer</source>
   <translation>Fase</translation>
  </message>
  <message>
   <source>chamfer of the glass's outer edges, at 45 deg</source>
   <translation>Fase der Außenkanten des Glases, unter 45 Grad</translation>
  </message>
  <message>
   <source>Plate release</source>
   <translation>Entformungsschräge</translation>
  </message>
  <message>
   <source>release taper of the epoxy's sides, narrower at the film</source>
   <translation>Entformungsschräge der Epoxidseiten, zum Film hin schmaler</translation>
  </message>
  <message>
   <source>Plate notch</source>
   <translation>Griffkerbe</translation>
  </message>
  <message>
   <source>handling notch: what is cut from a lower corner, the bottom plate's left and the top plate's right one</source>
   <translation>Griffkerbe: was an einer unteren Ecke abgeschnitten wird, links an der unteren, rechts an der oberen Platte</translation>
  </message>
  <message>
   <source>Plate engraving</source>
   <translation>Gravur</translation>
  </message>
  <message>
   <source>depth of BOTTOM or TOP and the design's code in the glass's outer face</source>
   <translation>Tiefe von BOTTOM oder TOP und dem Code des Entwurfs in der Außenseite des Glases</translation>
  </message>
  <message>
   <source>Plate frame</source>
   <translation>Ausrichtrahmen</translation>
  </message>
  <message>
   <source>wall of an alignment frame around both plates; 0: no frame</source>
   <translation>Wand eines Ausrichtrahmens um beide Platten; 0: kein Rahmen</translation>
  </message>
  <message>
   <source>Plate frame clearance</source>
   <translation>Spiel des Rahmens</translation>
  </message>
  <message>
   <source>between the plates and the alignment frame</source>
   <translation>zwischen den Platten und dem Ausrichtrahmen</translation>
  </message>
  <message>
   <source>Mark clearance</source>
   <translation>Abstand der Marken</translation>
  </message>
  <message>
   <source>from the sheet's bounding box to the marks</source>
   <translation>vom Hüllrechteck des Films zu den Marken</translation>
  </message>
  <message>
   <source>Mark tolerance</source>
   <translation>Toleranz der Marken</translation>
  </message>
  <message>
   <source>largest accepted mismatch of the plates</source>
   <translation>größter zulässiger Versatz der Platten</translation>
  </message>
  <message>
   <source>Mark grating</source>
   <translation>Gitter in Marken</translation>
  </message>
  <message>
   <source>fill the marks with the channels' grating, so that they are dark in the microscope</source>
   <translation>die Marken mit dem Gitter der Kanäle füllen, sodass sie im Mikroskop dunkel sind</translation>
  </message>
  <message>
   <source>Mark fields</source>
   <translation>Testfelder</translation>
  </message>
  <message>
   <source>test fields outside the sheet; leave out any</source>
   <translation>Testfelder außerhalb des Films; jedes kann entfallen</translation>
  </message>
  <message>
   <source>Mark printed label</source>
   <translation>Aufgedruckter Text</translation>
  </message>
  <message>
   <source>your own words beside the design's code: capital letters, digits, space, + - . /</source>
   <translation>eigener Text neben dem Code des Entwurfs: Großbuchstaben, Ziffern, Leerzeichen, + - . /</translation>
  </message>
  <message>
   <source>Spacer strip</source>
   <translation>Abstandsstreifen</translation>
  </message>
  <message>
   <source>width of a strip</source>
   <translation>Breite eines Streifens</translation>
  </message>
  <message>
   <source>Spacer clearance</source>
   <translation>Abstand der Streifen</translation>
  </message>
  <message>
   <source>between strips and sheet, and strips and marks</source>
   <translation>zwischen Streifen und Film sowie Streifen und Marken</translation>
  </message>
  <message>
   <source>Spacer glue</source>
   <translation>Kleberand</translation>
  </message>
  <message>
   <source>free glass outside each strip for the glue</source>
   <translation>freies Glas außerhalb jedes Streifens für den Kleber</translation>
  </message>
  <message>
   <source>Spacer bead</source>
   <translation>Kleberaupe</translation>
  </message>
  <message>
   <source>width of the glue beads there, at most glue_mm; 0: none</source>
   <translation>Breite der Kleberaupen dort, höchstens glue_mm; 0: keine</translation>
  </message>
  <message>
   <source>Solver starts</source>
   <translation>Starts des Lösers</translation>
  </message>
  <message>
   <source>number of stretch directions that compete</source>
   <translation>Anzahl der Streckrichtungen, die im Wettbewerb stehen</translation>
  </message>
  <message>
   <source>Solver tolerance</source>
   <translation>Toleranz des Lösers</translation>
  </message>
  <message>
   <source>relative energy decrease at which the solver stops</source>
   <translation>relative Abnahme der Energie, bei der der Löser anhält</translation>
  </message>
  <message>
   <source>Solver max iterations</source>
   <translation>Iterationsgrenze</translation>
  </message>
  <message>
   <source>iteration limit of one start</source>
   <translation>Iterationsgrenze eines Starts</translation>
  </message>
  <message>
   <source>Solver smoothing</source>
   <translation>Glättung</translation>
  </message>
  <message>
   <source>weight of the director's jumps between triangles; 0 meets the stretches best, 0.02 halves the jumps</source>
   <translation>Gewicht der Sprünge des Direktors zwischen Dreiecken; 0 trifft die Dehnungen am besten, 0.02 halbiert die Sprünge</translation>
  </message>
  <message>
   <source>Prediction correct</source>
   <translation>Korrektur durch Simulation</translation>
  </message>
  <message>
   <source>let the simulation correct the design: director and twist (full), the twist alone (dtheta), nothing (off)</source>
   <translation>die Simulation den Entwurf korrigieren lassen: Direktor und Verdrillung (full), nur die Verdrillung (dtheta), nichts (off)</translation>
  </message>
  <message>
   <source>Prediction seed</source>
   <translation>Startwert der Vorhersage</translation>
  </message>
  <message>
   <source>seed of the imperfection that the sheet starts with</source>
   <translation>Startwert der Unebenheit, mit der der Film beginnt</translation>
  </message>
  <message>
   <source>Prediction imperfection</source>
   <translation>Unebenheit</translation>
  </message>
  <message>
   <source>deviation of that imperfection, in thicknesses</source>
   <translation>Streuung dieser Unebenheit, in Filmdicken</translation>
  </message>
  <message>
   <source>Prediction steps</source>
   <translation>Schritte der Vorhersage</translation>
  </message>
  <message>
   <source>steps of the heating</source>
   <translation>Schritte des Erwärmens</translation>
  </message>
  <message>
   <source>Prediction plate</source>
   <translation>Heizplatte</translation>
  </message>
  <message>
   <source>the sheet has weight and lies on the hot plate, which it can leave upwards; without friction</source>
   <translation>das Blatt hat Gewicht und liegt auf der Heizplatte, von der es nach oben abheben kann; ohne Reibung</translation>
  </message>
  <message>
   <source>Prediction density kg m3</source>
   <translation>Dichte des Films (kg/m3)</translation>
  </message>
  <message>
   <source>density of the film</source>
   <translation>Dichte des Films</translation>
  </message>
  <message>
   <source>Prediction modulus mpa</source>
   <translation>Elastizitätsmodul (MPa)</translation>
  </message>
  <message>
   <source>Young's modulus of the hot film, which resists its weight</source>
   <translation>Elastizitätsmodul des heißen Films, der seinem Gewicht widersteht</translation>
  </message>
  <message>
   <source>Prediction film</source>
   <translation>Film der Erwärmung</translation>
  </message>
  <message>
   <source>write the heating as an animation, prediction_film.glb</source>
   <translation>die Erwärmung als Animation schreiben, prediction_film.glb</translation>
  </message>
  <message>
   <source>Output masks</source>
   <translation>Maskenformate</translation>
  </message>
  <message>
   <source>mask formats: gds, oas, dxf (R2000, for CAD), r12.dxf (for the writer, um), cif</source>
   <translation>Maskenformate: gds, oas, dxf (R2000, für CAD), r12.dxf (für den Schreiber, µm), cif</translation>
  </message>
  <message>
   <source>Output pictures</source>
   <translation>Bilder</translation>
  </message>
  <message>
   <source>pictures of the masks, mask/*.png</source>
   <translation>Bilder der Masken, mask/*.png</translation>
  </message>
  <message>
   <source>Output overlay x</source>
   <translation>Überlagerung x</translation>
  </message>
  <message>
   <source>shift of the top plate in the picture overlay.png</source>
   <translation>Versatz der oberen Platte im Bild overlay.png</translation>
  </message>
  <message>
   <source>Output overlay y</source>
   <translation>Überlagerung y</translation>
  </message>
  <message>
   <source>the same along y</source>
   <translation>dasselbe längs y</translation>
  </message>
  <message>
   <source>Output writer</source>
   <translation>Laserschreiber</translation>
  </message>
  <message>
   <source>smallest line and land of the laser writer's mode</source>
   <translation>kleinste Linie und kleinster Steg im Modus des Laserschreibers</translation>
  </message>
  <message>
   <source>Output freecad</source>
   <translation>FreeCAD-Dokument</translation>
  </message>
  <message>
   <source>write the FreeCAD document cad/cell.FCStd (needs freecadcmd)</source>
   <translation>das FreeCAD-Dokument cad/cell.FCStd schreiben (braucht freecadcmd)</translation>
  </message>
  <message>
   <source>Output cad</source>
   <translation>Weitere CAD-Dateien</translation>
  </message>
  <message>
   <source>further CAD files: domains (outlines named with their angles), sheet (flat, and as predicted when heated), stl, 3mf (plates, patterned face up, for a microprinter), svg, dxf (outlines of all parts, true mm)</source>
   <translation>weitere CAD-Dateien: domains (Umrisse, nach ihren Winkeln benannt), sheet (flach, und wie vorhergesagt erwärmt), stl, 3mf (Platten, Muster nach oben, für einen Mikrodrucker), svg, dxf (Umrisse aller Teile, in mm)</translation>
  </message>
  <message>
   <source>Output drawings</source>
   <translation>Zeichnungen</translation>
  </message>
  <message>
   <source>fabrication drawings, drawings/*.pdf, .svg, .dxf (needs freecadcmd)</source>
   <translation>Fertigungszeichnungen, drawings/*.pdf, .svg, .dxf (braucht freecadcmd)</translation>
  </message>
  <message>
   <source>Output author</source>
   <translation>Gezeichnet von</translation>
  </message>
  <message>
   <source>who drew it, for the drawings' title block</source>
   <translation>wer gezeichnet hat, für das Schriftfeld der Zeichnungen</translation>
  </message>
  <message>
   <source>Output date</source>
   <translation>Datum</translation>
  </message>
  <message>
   <source>date for the drawings' title block, as it shall stand there</source>
   <translation>Datum für das Schriftfeld der Zeichnungen, wie es dort stehen soll</translation>
  </message>
  <message>
   <source>Output step domains</source>
   <translation>Domänen als Körper</translation>
  </message>
  <message>
   <source>domains whose channels become solids; default: the most central</source>
   <translation>Domänen, deren Kanäle Körper werden; Standard: die mittlere</translation>
  </message>
  <message>
   <source>Output step window</source>
   <translation>Fenster</translation>
  </message>
  <message>
   <source>x0, y0, x1, y1 [um] of a window: the domains that it touches become solids too</source>
   <translation>x0, y0, x1, y1 [um] eines Fensters: auch die Domänen, die es berührt, werden Körper</translation>
  </message>
  <message>
   <source>Output step</source>
   <translation>STEP-Umfang</translation>
  </message>
  <message>
   <source>channel solids in cad/channels_*.step: of the chosen domains; all (some 250 MB a plate of 20 mm); or exact, each a solid of its own with its ends along the domain's border (some 6 GB, in files of 64 domains)</source>
   <translation>Kanalkörper in cad/channels_*.step: der gewählten Domänen; all: aller (etwa 250 MB je Platte von 20 mm); oder exact: jeder ein eigener Körper mit Enden entlang der Domänengrenze (etwa 6 GB, in Dateien zu 64 Domänen)</translation>
  </message>
  <message>
   <source>Output step instances</source>
   <translation>STEP-Instanzen</translation>
  </message>
  <message>
   <source>how channels of one length share a solid: mapped items, or assembly components (3 times larger) for programs that lose mapped items</source>
   <translation>wie sich Kanäle gleicher Länge einen Körper teilen: als mapped items oder als Baugruppenteile (dreimal größer) für Programme, die mapped items verlieren</translation>
  </message>
  <message>
   <source>Output relief</source>
   <translation>Relief</translation>
  </message>
  <message>
   <source>height map and mesh of a window (step_window_um, or 30 um) as the laser writes it: cad/relief_*</source>
   <translation>Höhenkarte und Netz eines Fensters (step_window_um, oder 30 um), wie der Laser es schreibt: cad/relief_*</translation>
  </message>
  <message>
   <source>Output relief spot</source>
   <translation>Schreibfleck des Reliefs</translation>
  </message>
  <message>
   <source>1/e2 diameter of the writing spot in the relief</source>
   <translation>1/e2-Durchmesser des Schreibflecks im Relief</translation>
  </message>
  <message>
   <source>Output relief contrast</source>
   <translation>Kontrast des Reliefs</translation>
  </message>
  <message>
   <source>contrast of the resist in the relief: 1 linear, large: a threshold</source>
   <translation>Kontrast des Lacks im Relief: 1 linear, groß: eine Schwelle</translation>
  </message>
  <message>
   <source>Output relief pixel nm</source>
   <translation>Pixel des Reliefs (nm)</translation>
  </message>
  <message>
   <source>pixel of the relief</source>
   <translation>Pixel des Reliefs</translation>
  </message>
  <message>
   <source>Output step gzip</source>
   <translation>STEP komprimieren</translation>
  </message>
  <message>
   <source>compress cad/channels_*.step to .step.gz</source>
   <translation>cad/channels_*.step zu .step.gz komprimieren</translation>
  </message>
 </context>
 <context>
  <name>LceMoldPreferences</name>
  <message>
   <source>General</source>
   <translation>Allgemein</translation>
  </message>
  <message>
   <source>Files</source>
   <translation>Dateien</translation>
  </message>
  <message>
   <source>Folder for outputs</source>
   <translation>Ordner für Ausgaben</translation>
  </message>
  <message>
   <source>Masks, exports and reviews go below this folder; empty: beside the document</source>
   <translation>Masken, Exporte und Prüfungen kommen in diesen Ordner; leer: neben das Dokument</translation>
  </message>
  <message>
   <source>Panels</source>
   <translation>Eingabefelder</translation>
  </message>
  <message>
   <source>Start a new cell with the values of last time</source>
   <translation>Eine neue Zelle mit den Werten vom letzten Mal beginnen</translation>
  </message>
  <message>
   <source>Drawn by</source>
   <translation>Gezeichnet von</translation>
  </message>
  <message>
   <source>Who stands in the title blocks of new cells</source>
   <translation>Wer in den Schriftfeldern neuer Zellen steht</translation>
  </message>
  <message>
   <source>Most channel solids</source>
   <translation>Höchstzahl von Kanalkörpern</translation>
  </message>
  <message>
   <source>Channel windows with more solids are refused: this machine would be too slow</source>
   <translation>Kanalfenster mit mehr Körpern werden abgelehnt: dieser Rechner wäre zu langsam</translation>
  </message>
 </context>
</TS>
